#include "tracking/pose_errors.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "tracking/tag_pose.hpp"
#include "tracking/validation.hpp"

namespace clearway {
namespace {

constexpr int kOwn = 11, kShared = kCameraModes + 1;

// How the corners move when one edge of the square is shifted by `bias` outwards: each of its two corners
// slides along the other edge that meets there.
void add_edges(const std::array<Eigen::Vector2d, 4>& corners, double bias, TagView& view) {
  constexpr double smallest_sine = 0.2;
  std::array<Eigen::Vector2d, 4> along;
  for (int i = 0; i < 4; ++i) along[i] = (corners[(i + 1) % 4] - corners[i]).normalized();
  for (int edge = 0; edge < 4; ++edge) {
    const int next = (edge + 1) % 4, before = (edge + 3) % 4;
    const Eigen::Vector2d outwards(along[edge].y(), -along[edge].x());  // clockwise on the image, y down
    const auto slide = [&](const Eigen::Vector2d& direction) -> Eigen::Vector2d {
      const double sine = outwards.dot(direction);
      return direction * (bias / std::copysign(std::max(std::abs(sine), smallest_sine), sine));
    };
    view.by_own.block<2, 1>(2 * edge, 7 + edge) = slide(along[before]);
    view.by_own.block<2, 1>(2 * next, 7 + edge) = slide(along[next]);
  }
}

}  // namespace

void TagErrors::validate(const std::string& body) const {
  const auto check = [&](const char* name, double value) {
    require(std::isfinite(value) && value >= 0.0, "tag body '" + body + "': errors: " + name, "0 or more");
  };
  check("scale", scale);
  check("size", size);
  check("place", place);
  check("turn", turn);
}

std::optional<TagView> view_tag(const Camera& camera, double size, const Eigen::Isometry3d& body_from_tag,
                                const TagErrors& errors, double edge_bias,
                                const std::array<Eigen::Vector2d, 4>& seen,
                                const Eigen::Isometry3d& camera_from_body) {
  TagView view;
  view.by_own.setZero();
  const std::array<Eigen::Vector3d, 4> in_tag = tag_corners(size);
  const Eigen::Matrix3d turn = body_from_tag.linear();
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d in_body = body_from_tag * in_tag[i];
    Eigen::Matrix<double, 2, 3> by_point;
    const auto pixel = camera.project(camera_from_body * in_body, by_point);
    if (!pixel) return std::nullopt;
    by_point = by_point * camera_from_body.linear();  // of the point in the body
    view.residual.segment<2>(2 * i) = *pixel - seen[i];
    view.by_motion.block<2, 3>(2 * i, 0) = by_point;
    view.by_motion.block<2, 3>(2 * i, 3) = -by_point * cross_matrix(in_body);
    view.by_shared.block<2, kCameraModes>(2 * i, 0) = camera.shift_by_errors(*pixel);
    view.by_shared.block<2, 1>(2 * i, kCameraModes) = by_point * (errors.scale * in_body);
    view.by_own.block<2, 1>(2 * i, 0) = by_point * (turn * (errors.size * in_tag[i]));
    view.by_own.block<2, 3>(2 * i, 1) = errors.place * by_point;
    view.by_own.block<2, 3>(2 * i, 4) = -errors.turn * by_point * turn * cross_matrix(in_tag[i]);
  }
  add_edges(seen, edge_bias, view);
  return view;
}

// Each tag's own errors and the noise make a covariance of 8 x 8; what all share enters through the matrix
// inversion lemma.
double unexplained(const std::vector<TagView>& tags, double noise_px) {
  double sum = 0.0;
  Eigen::Matrix<double, kShared, kShared> shared = Eigen::Matrix<double, kShared, kShared>::Identity();
  Eigen::Matrix<double, kShared, 1> pull = Eigen::Matrix<double, kShared, 1>::Zero();
  for (const TagView& tag : tags) {
    Eigen::Matrix<double, 8, 8> covariance = tag.by_own * tag.by_own.transpose();
    covariance.diagonal().array() += noise_px * noise_px;
    const Eigen::LLT<Eigen::Matrix<double, 8, 8>> solver(covariance);
    const Eigen::Matrix<double, 8, 1> weighed = solver.solve(tag.residual);
    sum += tag.residual.dot(weighed);
    shared += tag.by_shared.transpose() * solver.solve(tag.by_shared);
    pull += tag.by_shared.transpose() * weighed;
  }
  return sum - pull.dot(shared.llt().solve(pull));
}

std::optional<PoseErrors> carry_errors(const std::vector<TagView>& tags, double noise_px) {
  Matrix6d information = Matrix6d::Zero();
  for (const TagView& tag : tags) information += tag.by_motion.transpose() * tag.by_motion;
  const Eigen::LLT<Matrix6d> solver(information);
  if (solver.info() != Eigen::Success) return std::nullopt;
  PoseErrors errors;
  errors.noise = noise_px * noise_px * solver.solve(Matrix6d::Identity());
  Vector6d by_scale = Vector6d::Zero();
  for (const TagView& tag : tags) {
    const Eigen::Matrix<double, 6, 8> by_pixels = -solver.solve(tag.by_motion.transpose());
    errors.by_camera += by_pixels * tag.by_shared.leftCols<kCameraModes>();
    by_scale += by_pixels * tag.by_shared.col(kCameraModes);
    const Eigen::Matrix<double, 6, kOwn> own = by_pixels * tag.by_own;
    errors.tags += own.leftCols<7>() * own.leftCols<7>().transpose();
    errors.edges += own.rightCols<4>() * own.rightCols<4>().transpose();
  }
  errors.tags += by_scale * by_scale.transpose();
  const bool is_finite = errors.noise.allFinite() && errors.tags.allFinite() && errors.edges.allFinite() &&
                         errors.by_camera.allFinite();
  return is_finite ? std::optional(errors) : std::nullopt;
}

double chi_square_limit(int freedom) {
  constexpr double normal_quantile = 3.719;  // of 0.9999
  const double ninth = 2.0 / (9.0 * freedom);
  return freedom * std::pow(1.0 - ninth + normal_quantile * std::sqrt(ninth), 3.0);
}

double confidence_factor(int freedom) {
  constexpr double limit = 4.0331;  // the root of chi-square(3)'s quantile of 0.999
  const double share = 1.0 / std::max(10, freedom);
  return limit * (1.0 + share * (3.84 + 13.8 * share));  // above the exact value by 0.5 % at most
}

}  // namespace clearway
