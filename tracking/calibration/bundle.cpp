#include "tracking/calibration/bundle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "tracking/calibration/bundle_problem.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

/// Moves `state` to the least cost. True when steps have become small.
bool descend(const BundleProblem& problem, BundleState& state) {
  constexpr int most_steps = 60;
  double cost = problem.cost(state), damping = 1e-4;
  if (!std::isfinite(cost)) return false;
  for (int i = 0; i < most_steps; ++i) {
    const auto equations = problem.equations(state);
    if (!equations) return false;
    bool is_better = false;
    for (; damping < 1e8 && !is_better; damping *= is_better ? 0.1 : 10.0) {
      const Eigen::VectorXd step = problem.step(*equations, damping);
      if (!step.allFinite()) continue;
      const BundleState next = problem.moved(state, step);
      const double reached = problem.cost(next);
      is_better = reached < cost;
      if (!is_better) continue;
      const bool is_end = cost - reached < 1e-9 * cost + 1e-12;
      state = next;
      cost = reached;
      if (is_end) return true;
    }
    if (!is_better) return true;  // no step makes it less
    damping = std::max(damping, 1e-12);
  }
  return false;
}

void note_residuals(const BundleProblem& problem, const BundleState& state, const Bundle& bundle,
                    BundleFit& fit) {
  double squares = 0.0;
  int corners = 0;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    fit.tag_squares.emplace_back();
    for (std::size_t t = 0; t < bundle.views[v].tags.size(); ++t) {
      corners += 4;
      if (const auto misses = problem.misses_of(state, v, t))
        for (const Eigen::Vector2d& miss : *misses) squares += miss.squaredNorm();
      const auto residual = problem.residual_of(state, v, t);
      fit.tag_squares.back().push_back(residual ? residual->squaredNorm() : 0.0);
    }
  }
  fit.rms_px = std::sqrt(squares / std::max(1, corners));
  fit.freedom = std::max(1, 2 * corners + problem.priors() - problem.unknowns());
}

/// See adjust. Starts at `begin`, where there is one, and leaves there what it reached.
BundleFit adjust_from(std::optional<BundleState>& begin, Bundle& bundle, const BundlePriors& priors,
                      double noise_px, double edge_bias) {
  BundleFit fit;
  const BundleProblem problem(bundle, priors, noise_px, edge_bias);
  BundleState state = begin ? *begin : problem.start();
  fit.is_converged = descend(problem, state);
  const auto equations = problem.equations(state);
  if (!equations) return {};
  fit.covariance = problem.covariance(*equations);
  fit.is_converged = fit.is_converged && fit.covariance.size() > 0 && fit.covariance.allFinite();
  fit.chi_square = problem.cost(state);
  fit.noise_px = noise_px;
  note_residuals(problem, state, bundle, fit);
  std::map<int, MountedTag> tags;
  for (const auto& [id, tag] : bundle.board.tags) tags[id] = problem.mounted_of(state, id);
  fit.focal_steps = BundleProblem::focal_steps(*equations);
  if (fit.is_converged) fit.by_own_focal = BundleProblem::by_own_focal(*equations, fit.covariance);
  bundle.camera = state.camera;
  bundle.bend = state.bend;
  bundle.board.tags = tags;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) bundle.views[v].camera_from_board = state.poses[v];
  begin = std::move(state);
  return fit;
}

}  // namespace

std::array<Eigen::Vector2d, 4> outward(const std::array<Eigen::Vector2d, 4>& corners) {
  const Eigen::Vector2d middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
  const auto normal = [&](std::size_t i) {  // of the edge from this corner to the next
    const Eigen::Vector2d along = (corners[(i + 1) % 4] - corners[i % 4]).normalized();
    const Eigen::Vector2d across(along.y(), -along.x());
    return Eigen::Vector2d(across.dot(corners[i % 4] - middle) < 0.0 ? -across : across);
  };
  std::array<Eigen::Vector2d, 4> moved;
  for (std::size_t i = 0; i < 4; ++i) {  // to where the two edges moved by a pixel meet
    const Eigen::Vector2d before = normal(i + 3), after = normal(i);
    moved[i] = (before + after) / std::max(0.1, 1.0 + before.dot(after));
  }
  return moved;
}

std::array<Eigen::Vector3d, 4> corners_on_board(const MountedTag& tag, const BoardBend& bend) {
  auto corners = tag_corners(tag.size);
  for (Eigen::Vector3d& corner : corners) corner = bend.bent(tag.body_from_tag * corner);
  return corners;
}

std::size_t tags_of(const std::vector<BoardView>& views) {
  std::size_t tags = 0;
  for (const BoardView& view : views) tags += view.tags.size();
  return tags;
}

Eigen::Matrix<double, 2, kLensUnknowns> seen_by_coefficients(const Camera& camera,
                                                             const Eigen::Vector2d& ray) {
  const double x = ray.x(), y = ray.y(), r2 = ray.squaredNorm();
  Eigen::Matrix<double, 2, kLensUnknowns> by = Eigen::Matrix<double, 2, kLensUnknowns>::Zero();
  if (camera.lens == LensDistortion::Model::fisheye) {
    const double r = std::sqrt(r2), angle = std::atan(r);
    if (r < 1e-9) return by;
    double power = angle * angle * angle;
    for (int i = 0; i < 4; ++i, power *= angle * angle) by.col(i) = power / r * ray;
    return by;
  }
  const auto& k = camera.distortion;
  const double below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / below;
  by.col(0) = r2 / below * ray;
  by.col(1) = r2 * by.col(0);
  by.col(2) << 2.0 * x * y, r2 + 2.0 * y * y;
  by.col(3) << r2 + 2.0 * x * x, 2.0 * x * y;
  by.col(4) = r2 * by.col(1);
  if (camera.lens != LensDistortion::Model::rational) return by;
  by.col(5) = -radial * by.col(0);
  by.col(6) = -radial * by.col(1);
  by.col(7) = -radial * by.col(4);
  return by;
}

Eigen::MatrixXd pixel_by_camera(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d off = *camera.project(point) - Eigen::Vector2d(camera.cx, camera.cy);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, kSharedUnknowns);
  by.leftCols<4>() << off.x(), 0.5 * off.x(), 1.0, 0.0, off.y(), -0.5 * off.y(), 0.0, 1.0;
  by.middleCols<kLensUnknowns>(4) = Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() *
                                    seen_by_coefficients(camera, point.head<2>() / point.z());
  return by;
}

std::array<double, kSharedUnknowns> camera_priors(const Camera& camera) {
  // What shifts the image's farthest corner by `distortion` pixels; see Camera::shift_by_errors.
  const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  const double r = std::hypot(x, y), f = std::sqrt(camera.fx * camera.fy);
  const bool is_given = camera.distortion != LensDistortion::Coefficients{};
  const double px =
      camera.errors.distortion.value_or(is_given ? 0.5 : 0.005 * std::hypot(camera.width, camera.height));
  const CameraErrors& e = camera.errors;
  if (camera.lens == LensDistortion::Model::fisheye)  // r is an angle there
    return {e.focal,
            e.aspect,
            e.center,
            e.center,
            px / (f * std::pow(r, 3)),
            px / (f * std::pow(r, 5)),
            px / (f * std::pow(r, 7)),
            px / (f * std::pow(r, 9))};
  return {e.focal,
          e.aspect,
          e.center,
          e.center,
          px / (f * std::pow(r, 3)),
          px / (f * std::pow(r, 5)),
          px / (3.0 * f * r * r),
          px / (3.0 * f * r * r)};
}

BundleFit adjust(Bundle& bundle, const BundlePriors& priors, double noise_px, double edge_bias) {
  std::optional<BundleState> from_given;
  return adjust_from(from_given, bundle, priors, noise_px, edge_bias);
}

BundleFit adjust_with_noise(Bundle& bundle, const BundlePriors& priors, double edge_bias) {
  constexpr double least_noise = 0.005;
  double noise = 0.3;
  const Bundle given = bundle;
  BundleFit fit;
  std::optional<BundleState> reached;  // by the round before: the next one has little way to go
  for (int round = 0; round < 6; ++round) {
    // The priors hold about what was given, not about what an earlier round has found.
    Bundle again = given;
    fit = adjust_from(reached, again, priors, noise, edge_bias);
    bundle = again;
    if (!fit.is_converged) return fit;
    const double factor = std::sqrt(fit.chi_square / fit.freedom);
    if (std::abs(factor - 1.0) < 0.02 || (noise <= least_noise && factor < 1.0)) break;
    noise = std::max(least_noise, noise * factor);
    // Edge bias that the residuals do not show is not there.
    if (factor < 1.0) edge_bias *= factor;
  }
  return fit;
}

}  // namespace clearway
