#include "tracking/center_bound.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/dense.hpp"

namespace clearway {
namespace {

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return UncertainPoint{{}, covariance}.largest_sigma();
}

// How far the ball is off when one of the two poses is one of its limits.
double farthest_move(const std::vector<Eigen::Isometry3d>& base_from_probe, const Eigen::Vector3d& ball,
                     const Eigen::Vector3d& center) {
  double most = 0.0;
  for (const Eigen::Isometry3d& pose : base_from_probe) most = std::max(most, (pose * ball - center).norm());
  return most;
}

/// Covariances of a point by each source of error; `widest` is how far the poses' limits move it.
CenterBound added_up(const Eigen::Matrix3d& noise, const Eigen::Matrix3d& camera, const Eigen::Matrix3d& tags,
                     const Eigen::Matrix3d& edges, double widest, int freedom) {
  const double of_noise = confidence_factor(freedom);
  const double of_model = confidence_factor(1000000);
  CenterBound bound;
  bound.noise = of_noise * largest_sigma(noise);
  bound.camera = of_model * largest_sigma(camera);
  bound.tags = of_model * largest_sigma(tags);
  bound.edges = of_model * largest_sigma(edges);
  const double linear =
      largest_sigma(of_noise * of_noise * noise + of_model * of_model * (camera + tags + edges));
  bound.tilt = std::sqrt(std::max(0.0, widest * widest - bound.noise * bound.noise));
  bound.total = std::hypot(linear, bound.tilt);
  return bound;
}

/// Of a point that the pose alone moves, by `by_motion`; `limits` are the places it may have.
CenterBound of_one_body(const BodyPose& body, const Matrix36d& by_motion,
                        const std::vector<Eigen::Isometry3d>& limits, const Eigen::Vector3d& point,
                        const Eigen::Vector3d& found, int noise_freedom) {
  const PoseErrors& errors = body.errors;
  return added_up(sandwich(by_motion, errors.noise), squared(product(by_motion, errors.by_camera)),
                  sandwich(by_motion, errors.tags), sandwich(by_motion, errors.edges),
                  farthest_move(limits, point, found), noise_freedom + body.freedom);
}

}  // namespace

CenterBound bound_center(const BodyPose& base, const UncertainPose& camera_from_base, bool is_mean,
                         const BodyPose& probe, const Eigen::Vector3d& ball, int noise_freedom) {
  const Eigen::Isometry3d base_from_camera = camera_from_base.pose.inverse();
  const Eigen::Isometry3d camera_from_probe = probe.camera_from_body.pose;
  const Eigen::Isometry3d base_from_probe = base_from_camera * camera_from_probe;
  const Eigen::Vector3d center = base_from_probe * ball;
  const Matrix36d by_base = -point_by_motion(center);
  const Matrix36d by_probe = product(base_from_probe.linear(), point_by_motion(ball));
  const auto carried = [&](const Matrix6d& of_base, const Matrix6d& of_probe) -> Eigen::Matrix3d {
    return sandwich(by_base, of_base) + sandwich(by_probe, of_probe);
  };

  const Matrix6d base_noise =
      is_mean ? Matrix6d(base.noise_factor * base.noise_factor * camera_from_base.covariance)
              : base.errors.noise;
  const Eigen::Matrix3d noise = carried(base_noise, probe.errors.noise);
  const Eigen::MatrixXd by_camera =
      product(by_base, base.errors.by_camera) + product(by_probe, probe.errors.by_camera);
  const Eigen::Matrix3d tags = carried(base.errors.tags, probe.errors.tags);
  const Eigen::Matrix3d edges = carried(base.errors.edges, probe.errors.edges);

  std::vector<Eigen::Isometry3d> turned;
  for (const Eigen::Isometry3d& limit : probe.limits) turned.push_back(base_from_camera * limit);
  const double by_probe_turned = farthest_move(turned, ball, center);
  turned.clear();
  if (!is_mean)
    for (const Eigen::Isometry3d& limit : base.limits) turned.push_back(limit.inverse() * camera_from_probe);
  const double widest = std::hypot(by_probe_turned, farthest_move(turned, ball, center));
  return added_up(noise, squared(by_camera), tags, edges, widest,
                  noise_freedom + std::min(base.freedom, probe.freedom));
}

CenterBound bound_point(const BodyPose& body, const Eigen::Vector3d& point, int noise_freedom) {
  const Eigen::Isometry3d& pose = body.camera_from_body.pose;
  return of_one_body(body, product(pose.linear(), point_by_motion(point)), body.limits, point, pose * point,
                     noise_freedom);
}

CenterBound bound_camera(const BodyPose& body, int noise_freedom) {
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Eigen::Vector3d camera = body.camera_from_body.pose.inverse() * origin;
  std::vector<Eigen::Isometry3d> limits;
  for (const Eigen::Isometry3d& limit : body.limits) limits.push_back(limit.inverse());
  return of_one_body(body, -point_by_motion(camera), limits, origin, camera, noise_freedom);
}

}  // namespace clearway
