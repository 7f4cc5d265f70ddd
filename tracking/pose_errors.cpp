#include "tracking/pose_errors.hpp"

#include <cmath>

#include "tracking/dense.hpp"
#include "tracking/tag_pose.hpp"
#include "tracking/validation.hpp"

namespace clearway {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;

Matrix23d turned_by(const Matrix23d& by, const Eigen::Matrix3d& turn) { return by * turn; }

Eigen::Vector2d along(const Matrix23d& by, const Eigen::Vector3d& way) { return by * way; }

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
    Matrix23d by_point;
    const auto pixel = camera.project(camera_from_body * in_body, by_point);
    if (!pixel) return std::nullopt;
    by_point = turned_by(by_point, camera_from_body.linear());  // of the point in the body
    const Matrix23d by_corner = turned_by(by_point, turn);      // of the corner in the tag
    view.residual.segment<2>(2 * i) = *pixel - seen[i];
    view.by_motion.block<2, 3>(2 * i, 0) = by_point;
    view.by_motion.block<2, 3>(2 * i, 3) = turned_by(by_point, cross_matrix(-in_body));
    view.by_shared.block<2, kCameraModes>(2 * i, 0) = camera.shift_by_errors(*pixel);
    view.by_shared.block<2, 1>(2 * i, kCameraModes) = along(by_point, errors.scale * in_body);
    view.by_own.block<2, 1>(2 * i, 0) = along(by_corner, errors.size * in_tag[i]);
    view.by_own.block<2, 3>(2 * i, 1) = errors.place * by_point;
    view.by_own.block<2, 3>(2 * i, 4) = turned_by(by_corner, cross_matrix(-errors.turn * in_tag[i]));
  }
  add_edges(seen, edge_bias, view);
  return view;
}

// Each tag's own errors and the noise make a covariance of 8 x 8; what all share enters through the matrix
// inversion lemma.
double unexplained(const std::vector<TagView>& tags, double noise_px) {
  double sum = 0.0;
  Eigen::MatrixXd shared = Eigen::MatrixXd::Identity(kCameraModes + 1, kCameraModes + 1);
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(kCameraModes + 1, 1);
  for (const TagView& tag : tags) {
    const Cholesky covariance(squared(tag.by_own) + noise_px * noise_px * Eigen::MatrixXd::Identity(8, 8));
    const Eigen::MatrixXd weighed = covariance.solve(tag.residual);
    sum += transposed_product(tag.residual, weighed)(0, 0);
    shared += transposed_product(tag.by_shared, covariance.solve(tag.by_shared));
    pull += transposed_product(tag.by_shared, weighed);
  }
  return sum - Cholesky(shared).squared(pull);
}

std::optional<PoseErrors> carry_errors(const std::vector<TagView>& tags, double noise_px) {
  Matrix6d information = Matrix6d::Zero();
  for (const TagView& tag : tags) information += transposed_product(tag.by_motion, tag.by_motion);
  const Cholesky solver(information);
  if (!solver.is_positive()) return std::nullopt;
  PoseErrors errors;
  errors.noise = noise_px * noise_px * solver.inverse();
  Eigen::MatrixXd by_scale = Eigen::MatrixXd::Zero(6, 1);
  for (const TagView& tag : tags) {
    const Eigen::MatrixXd by_pixels = -solver.solve(tag.by_motion.transpose());
    const Eigen::MatrixXd shared = product(by_pixels, tag.by_shared), own = product(by_pixels, tag.by_own);
    errors.by_camera += shared.leftCols(kCameraModes);
    by_scale += shared.rightCols(1);
    errors.tags += squared(own.leftCols(7));
    errors.edges += squared(own.rightCols(4));
  }
  errors.tags += squared(by_scale);
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
