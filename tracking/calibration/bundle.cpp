#include "tracking/calibration/bundle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

// Sizes are dynamic although they are known: fixed ones took half a minute to compile.
constexpr int kFirstOfPose = kCameraUnknowns + kTagUnknowns;

/// One tag of one view, whitened: its eight residuals, and their derivatives by camera, tag and pose.
struct Block {
  Eigen::VectorXd residual{8};
  Eigen::MatrixXd by{8, kFirstOfPose + 6};
};

/// What the unknowns of camera and tags have become, and the poses.
struct State {
  Camera camera;
  std::vector<Eigen::VectorXd> tags;  ///< from where they were given
  std::vector<Eigen::Isometry3d> poses;
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(kCameraUnknowns);
};

Eigen::Matrix3d turned(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

Eigen::Vector3d log_of(const Eigen::Matrix3d& turn) {
  const Eigen::AngleAxisd by(turn);
  return by.angle() * by.axis();
}

/// The derivative of a pixel by the camera's unknowns. @param point in the camera, in sight
Eigen::MatrixXd pixel_by_camera(const Camera& camera, const Eigen::Vector3d& point) {
  const double x = point.x() / point.z(), y = point.y() / point.z(), r2 = x * x + y * y;
  const auto& k = camera.distortion;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double xd = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
  const double yd = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  const double fx = camera.fx, fy = camera.fy;
  Eigen::MatrixXd by(2, kCameraUnknowns);
  by << fx * xd, 0.5 * fx * xd, 1.0, 0.0, fx * x * r2, fx * x * r2 * r2, 2.0 * fx * x * y,
      fx * (r2 + 2.0 * x * x), fx * x * r2 * r2 * r2,  //
      fy * yd, -0.5 * fy * yd, 0.0, 1.0, fy * y * r2, fy * y * r2 * r2, fy * (r2 + 2.0 * y * y),
      2.0 * fy * x * y, fy * y * r2 * r2 * r2;
  return by;
}

void move_camera(Camera& camera, const Eigen::VectorXd& step) {
  camera.fx *= std::exp(step[0] + 0.5 * step[1]);
  camera.fy *= std::exp(step[0] - 0.5 * step[1]);
  camera.cx += step[2];
  camera.cy += step[3];
  for (int i = 0; i < 5; ++i) camera.distortion[static_cast<std::size_t>(i)] += step[4 + i];
}

/// Bundle and priors with what never changes in them.
class Adjustment {
 public:
  Adjustment(const Bundle& bundle, const BundlePriors& priors, double noise_px, double edge_bias)
      : bundle_(bundle), size_(kCameraUnknowns + kTagUnknowns * static_cast<int>(bundle.board.tags.size())) {
    for (const auto& [id, tag] : bundle.board.tags) order_.emplace(id, static_cast<int>(order_.size()));
    sigma_.resize(size_);
    for (int i = 0; i < kCameraUnknowns; ++i) sigma_[i] = priors.camera[static_cast<std::size_t>(i)];
    for (std::size_t tag = 0; tag < priors.tags.size(); ++tag)
      for (int i = 0; i < kTagUnknowns; ++i)
        sigma_[column(static_cast<int>(tag)) + i] = priors.tags[tag][static_cast<std::size_t>(i)];
    for (const BoardView& view : bundle.views) {
      whitening_.emplace_back();
      for (const TagDetection& tag : view.tags)
        whitening_.back().push_back(whitening(view, tag, noise_px, edge_bias));
    }
  }

  State start() const {
    State state{bundle_.camera, {}, {}};
    state.tags.resize(order_.size(), Eigen::VectorXd::Zero(kTagUnknowns));
    for (const BoardView& view : bundle_.views) state.poses.push_back(view.camera_from_board);
    return state;
  }

  /// The sum of all squares; infinity where a corner is out of sight.
  double cost(const State& state) const {
    double sum = squares_of_priors(state);
    for (std::size_t v = 0; v < bundle_.views.size(); ++v)
      for (std::size_t t = 0; t < bundle_.views[v].tags.size(); ++t) {
        const auto residual = residual_of(state, v, t);
        if (!residual) return std::numeric_limits<double>::infinity();
        sum += residual->squaredNorm();
      }
    return sum;
  }

  std::optional<Eigen::VectorXd> residual_of(const State& state, std::size_t view, std::size_t tag) const {
    Eigen::VectorXd residual(8);
    const TagDetection& seen = bundle_.views[view].tags[tag];
    const MountedTag mounted = mounted_of(state, seen.id);
    const auto corners = tag_corners(mounted.size);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = state.camera.project(state.poses[view] * (mounted.body_from_tag * corners[i]));
      if (!pixel) return std::nullopt;
      residual.segment<2>(2 * static_cast<int>(i)) = *pixel - seen.corners[i];
    }
    return product(whitening_[view][tag], residual);
  }

  /// The normal equations at `state`: those of the shared unknowns, and what eliminating the poses needs.
  struct Equations {
    Eigen::MatrixXd shared;
    Eigen::VectorXd pull;
    std::vector<Eigen::MatrixXd> mixed, pose;
    std::vector<Eigen::VectorXd> pose_pull;
  };

  std::optional<Equations> equations(const State& state) const {
    Equations e;
    e.shared = Eigen::MatrixXd::Zero(size_, size_);
    e.pull = Eigen::VectorXd::Zero(size_);
    add_priors(state, e);
    for (std::size_t v = 0; v < bundle_.views.size(); ++v) {
      e.mixed.emplace_back(Eigen::MatrixXd::Zero(size_, 6));
      e.pose.emplace_back(Eigen::MatrixXd::Zero(6, 6));
      e.pose_pull.emplace_back(Eigen::VectorXd::Zero(6));
      for (std::size_t t = 0; t < bundle_.views[v].tags.size(); ++t) {
        const auto block = block_of(state, v, t);
        if (!block) return std::nullopt;
        add_block(*block, column(order_.at(bundle_.views[v].tags[t].id)), e);
      }
    }
    return e;
  }

  /// The step that the damped equations ask for. The last 6 x views entries are the poses'.
  Eigen::VectorXd step(const Equations& e, double damping) const {
    Eigen::MatrixXd reduced = e.shared;
    reduced.diagonal() *= 1.0 + damping;
    Eigen::VectorXd pull = e.pull;
    std::vector<Cholesky> solvers;
    for (std::size_t v = 0; v < e.pose.size(); ++v) {
      Eigen::MatrixXd pose = e.pose[v];
      pose.diagonal() *= 1.0 + damping;
      solvers.emplace_back(pose);
      reduced -= product(e.mixed[v], solvers.back().solve(e.mixed[v].transpose()));
      pull -= product(e.mixed[v], solvers.back().solve(e.pose_pull[v]));
    }
    Eigen::VectorXd step(size_ + 6 * static_cast<int>(e.pose.size()));
    step.head(size_) = -solve_symmetric(reduced, pull);
    for (std::size_t v = 0; v < e.pose.size(); ++v)
      step.segment(size_ + 6 * static_cast<int>(v), 6) =
          -solvers[v].solve(e.pose_pull[v] + transposed_product(e.mixed[v], step.head(size_)));
    return step;
  }

  State moved(const State& from, const Eigen::VectorXd& step) const {
    State to = from;
    move_camera(to.camera, step);
    to.shift += step.head(kCameraUnknowns);
    for (std::size_t t = 0; t < to.tags.size(); ++t) {
      const Eigen::VectorXd by = step.segment(column(static_cast<int>(t)), kTagUnknowns);
      to.tags[t].head(4) += by.head(4);
      to.tags[t].tail<3>() = log_of(turned(to.tags[t].tail<3>()) * turned(by.tail<3>()));
    }
    for (std::size_t v = 0; v < to.poses.size(); ++v)
      to.poses[v] = clearway::moved(to.poses[v], step.segment<6>(size_ + 6 * static_cast<int>(v)));
    return to;
  }

  /// Of the shared unknowns, poses eliminated; empty where these are not determined.
  Eigen::MatrixXd covariance(const Equations& e) const {
    Eigen::MatrixXd reduced = e.shared;
    for (std::size_t v = 0; v < e.pose.size(); ++v)
      reduced -= product(e.mixed[v], Cholesky(e.pose[v]).solve(e.mixed[v].transpose()));
    const Cholesky solver(reduced);
    if (!solver.is_positive()) return {};
    Eigen::MatrixXd covariance = solver.inverse();
    for (int i = 0; i < size_; ++i)
      if (sigma_[i] == 0.0) {
        covariance.row(i).setZero();
        covariance.col(i).setZero();
      }
    return covariance;
  }

  MountedTag mounted_of(const State& state, int id) const {
    MountedTag tag = bundle_.board.tags.at(id);
    const auto& off = state.tags[static_cast<std::size_t>(order_.at(id))];
    tag.size *= std::exp(off[0]);
    tag.body_from_tag.translation() += off.segment<3>(1);
    tag.body_from_tag.linear() *= turned(off.tail<3>());
    return tag;
  }

  int unknowns() const { return static_cast<int>((sigma_.array() > 0.0).count() + 6 * bundle_.views.size()); }
  int priors() const { return static_cast<int>((sigma_.array() > 0.0 && sigma_.array().isFinite()).count()); }

 private:
  static int column(int tag) { return kCameraUnknowns + kTagUnknowns * tag; }

  /// W with W^T W the inverse of the covariance of a tag's corners.
  Eigen::MatrixXd whitening(const BoardView& view, const TagDetection& tag, double noise_px,
                            double edge_bias) const {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
    const MountedTag& mounted = bundle_.board.tags.at(tag.id);
    if (const auto seen = view_tag(bundle_.camera, mounted.size, mounted.body_from_tag, {}, edge_bias,
                                   tag.corners, view.camera_from_board)) {
      covariance = squared(seen->by_own.rightCols<4>());
    }
    covariance.diagonal().array() += noise_px * noise_px;
    return Cholesky(covariance).whitening();
  }

  double off(const State& state, int i) const {
    if (i < kCameraUnknowns) return state.shift[i];
    const int tag = (i - kCameraUnknowns) / kTagUnknowns;
    return state.tags[static_cast<std::size_t>(tag)][(i - kCameraUnknowns) % kTagUnknowns];
  }

  double squares_of_priors(const State& state) const {
    double sum = 0.0;
    for (int i = 0; i < size_; ++i)
      if (sigma_[i] > 0.0 && std::isfinite(sigma_[i])) sum += std::pow(off(state, i) / sigma_[i], 2);
    return sum;
  }

  void add_priors(const State& state, Equations& e) const {
    for (int i = 0; i < size_; ++i) {
      if (sigma_[i] == 0.0) e.shared(i, i) = 1.0;
      if (!(sigma_[i] > 0.0) || !std::isfinite(sigma_[i])) continue;
      e.shared(i, i) = 1.0 / (sigma_[i] * sigma_[i]);
      e.pull[i] = off(state, i) / (sigma_[i] * sigma_[i]);
    }
  }

  std::optional<Block> block_of(const State& state, std::size_t view, std::size_t tag) const {
    Block block;
    const TagDetection& seen = bundle_.views[view].tags[tag];
    const MountedTag mounted = mounted_of(state, seen.id);
    const Eigen::Isometry3d& pose = state.poses[view];
    const Eigen::Matrix3d turn = mounted.body_from_tag.linear();
    const auto corners = tag_corners(mounted.size);
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d& in_tag = corners[static_cast<std::size_t>(i)];
      const Eigen::Vector3d in_board = mounted.body_from_tag * in_tag, in_camera = pose * in_board;
      Eigen::Matrix<double, 2, 3> by_point;
      const auto pixel = state.camera.project(in_camera, by_point);
      if (!pixel) return std::nullopt;
      by_point = by_point * pose.linear();
      block.residual.segment<2>(2 * i) = *pixel - seen.corners[static_cast<std::size_t>(i)];
      block.by.block(2 * i, 0, 2, kCameraUnknowns) = pixel_by_camera(state.camera, in_camera);
      block.by.block<2, 1>(2 * i, kCameraUnknowns) = by_point * (turn * in_tag);
      block.by.block<2, 3>(2 * i, kCameraUnknowns + 1) = by_point;
      block.by.block<2, 3>(2 * i, kCameraUnknowns + 4) = -by_point * turn * cross_matrix(in_tag);
      block.by.block<2, 3>(2 * i, kFirstOfPose) = by_point;
      block.by.block<2, 3>(2 * i, kFirstOfPose + 3) = -by_point * cross_matrix(in_board);
    }
    const Eigen::MatrixXd& white = whitening_[view][tag];
    block.residual = product(white, block.residual);
    block.by = product(white, block.by);
    const int own = column(order_.at(seen.id));
    for (int i = 0; i < kFirstOfPose; ++i)
      if (sigma_[i < kCameraUnknowns ? i : own + i - kCameraUnknowns] == 0.0) block.by.col(i).setZero();
    return block;
  }

  static void add_block(const Block& block, int own, Equations& e) {
    constexpr int camera = kCameraUnknowns, tag = kTagUnknowns;
    const Eigen::MatrixXd square = transposed_product(block.by, block.by);
    const Eigen::VectorXd pull = transposed_product(block.by, block.residual);
    e.shared.topLeftCorner(camera, camera) += square.topLeftCorner(camera, camera);
    e.shared.block(0, own, camera, tag) += square.block(0, camera, camera, tag);
    e.shared.block(own, 0, tag, camera) += square.block(camera, 0, tag, camera);
    e.shared.block(own, own, tag, tag) += square.block(camera, camera, tag, tag);
    e.pull.head(camera) += pull.head(camera);
    e.pull.segment(own, tag) += pull.segment(camera, tag);
    e.mixed.back().topRows(camera) += square.topRightCorner(camera, 6);
    e.mixed.back().middleRows(own, tag) += square.block(camera, kFirstOfPose, tag, 6);
    e.pose.back() += square.bottomRightCorner(6, 6);
    e.pose_pull.back() += pull.tail(6);
  }

  const Bundle& bundle_;
  int size_;
  std::map<int, int> order_;
  Eigen::VectorXd sigma_;
  std::vector<std::vector<Eigen::MatrixXd>> whitening_;
};

/// Moves `state` to the least cost. True when steps have become small.
bool descend(const Adjustment& adjustment, State& state) {
  constexpr int most_steps = 60;
  double cost = adjustment.cost(state), damping = 1e-4;
  if (!std::isfinite(cost)) return false;
  for (int i = 0; i < most_steps; ++i) {
    const auto equations = adjustment.equations(state);
    if (!equations) return false;
    bool is_better = false;
    for (; damping < 1e8 && !is_better; damping *= is_better ? 0.1 : 10.0) {
      const Eigen::VectorXd step = adjustment.step(*equations, damping);
      if (!step.allFinite()) continue;
      const State next = adjustment.moved(state, step);
      const double reached = adjustment.cost(next);
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

void note_residuals(const Adjustment& adjustment, const State& state, const Bundle& bundle, BundleFit& fit) {
  double squares = 0.0;
  int corners = 0;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    fit.tag_squares.emplace_back();
    for (std::size_t t = 0; t < bundle.views[v].tags.size(); ++t) {
      const TagDetection& seen = bundle.views[v].tags[t];
      const MountedTag mounted = adjustment.mounted_of(state, seen.id);
      const auto points = tag_corners(mounted.size);
      for (std::size_t i = 0; i < 4; ++i, ++corners)
        if (const auto pixel = state.camera.project(state.poses[v] * (mounted.body_from_tag * points[i])))
          squares += (*pixel - seen.corners[i]).squaredNorm();
      const auto residual = adjustment.residual_of(state, v, t);
      fit.tag_squares.back().push_back(residual ? residual->squaredNorm() : 0.0);
    }
  }
  fit.rms_px = std::sqrt(squares / std::max(1, corners));
  fit.freedom = std::max(1, 2 * corners + adjustment.priors() - adjustment.unknowns());
}

}  // namespace

std::array<double, kCameraUnknowns> camera_priors(const Camera& camera) {
  // What shifts the image's farthest corner by `distortion` pixels; see Camera::shift_by_errors.
  const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  const double r = std::hypot(x, y), f = std::sqrt(camera.fx * camera.fy);
  const bool is_given = camera.distortion != std::array<double, 5>{};
  const double px =
      camera.errors.distortion.value_or(is_given ? 0.5 : 0.005 * std::hypot(camera.width, camera.height));
  const CameraErrors& e = camera.errors;
  return {e.focal,
          e.aspect,
          e.center,
          e.center,
          px / (f * std::pow(r, 3)),
          px / (f * std::pow(r, 5)),
          px / (3.0 * f * r * r),
          px / (3.0 * f * r * r),
          0.0};
}

BundleFit adjust(Bundle& bundle, const BundlePriors& priors, double noise_px, double edge_bias) {
  BundleFit fit;
  const Adjustment adjustment(bundle, priors, noise_px, edge_bias);
  State state = adjustment.start();
  fit.is_converged = descend(adjustment, state);
  const auto equations = adjustment.equations(state);
  if (!equations) return {};
  fit.covariance = adjustment.covariance(*equations);
  fit.is_converged = fit.is_converged && fit.covariance.size() > 0 && fit.covariance.allFinite();
  fit.chi_square = adjustment.cost(state);
  fit.noise_px = noise_px;
  note_residuals(adjustment, state, bundle, fit);
  std::map<int, MountedTag> tags;
  for (const auto& [id, tag] : bundle.board.tags) tags[id] = adjustment.mounted_of(state, id);
  bundle.camera = state.camera;
  bundle.board.tags = tags;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) bundle.views[v].camera_from_board = state.poses[v];
  return fit;
}

BundleFit adjust_with_noise(Bundle& bundle, const BundlePriors& priors, double edge_bias) {
  constexpr double least_noise = 0.005;
  double noise = 0.3;
  const Bundle given = bundle;
  BundleFit fit;
  for (int round = 0; round < 6; ++round) {
    // The priors hold about what was given, not about what an earlier round has found.
    Bundle again = given;
    fit = adjust(again, priors, noise, edge_bias);
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
