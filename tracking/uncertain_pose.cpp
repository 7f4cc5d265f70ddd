#include "tracking/uncertain_pose.hpp"

#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cmath>

#include "tracking/dense.hpp"

namespace clearway {
namespace {

using mrpt::poses::CPose3D;

CPose3D to_mrpt(const Eigen::Isometry3d& pose) { return CPose3D(mrpt::math::CMatrixDouble44(pose.matrix())); }

Eigen::Isometry3d from_mrpt(const CPose3D& pose) {
  const auto m = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>();
  Eigen::Isometry3d out(Eigen::Matrix4d(m.asEigen()));
  out.linear() = Eigen::Quaterniond(out.linear()).normalized().toRotationMatrix();
  return out;
}

}  // namespace

Matrix6d adjoint(const Eigen::Isometry3d& a_from_b) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = a_from_b.linear();
  m.topRightCorner<3, 3>() = cross_matrix(a_from_b.translation()) * a_from_b.linear();
  return m;
}

Matrix6d carried(const Eigen::Isometry3d& a_from_b, const Matrix6d& covariance_in_b) {
  const Matrix6d covariance = sandwich(adjoint(a_from_b), covariance_in_b);
  return 0.5 * (covariance + covariance.transpose());
}

double UncertainPoint::largest_sigma() const {
  return std::sqrt(std::max(0.0, principal_axes(covariance).values.maxCoeff()));
}

UncertainPose inverse(const UncertainPose& a_from_b) {
  return {from_mrpt(-to_mrpt(a_from_b.pose)), carried(a_from_b.pose, a_from_b.covariance)};
}

UncertainPose compose(const UncertainPose& a_from_b, const UncertainPose& b_from_c) {
  const CPose3D a_from_c = to_mrpt(a_from_b.pose) + to_mrpt(b_from_c.pose);
  return {from_mrpt(a_from_c), carried(b_from_c.pose.inverse(), a_from_b.covariance) + b_from_c.covariance};
}

UncertainPose base_from_probe(const UncertainPose& camera_from_base, const UncertainPose& camera_from_probe) {
  const UncertainPose base_from_camera = inverse(camera_from_base);
  return compose(base_from_camera, camera_from_probe);
}

UncertainPoint transform(const UncertainPose& a_from_b, const Eigen::Vector3d& point) {
  const Matrix36d by_motion = product(a_from_b.pose.linear(), point_by_motion(point));
  return {a_from_b.pose * point, sandwich(by_motion, a_from_b.covariance)};
}

Matrix36d point_by_motion(const Eigen::Vector3d& point) {
  Matrix36d by_motion;
  by_motion << Eigen::Matrix3d::Identity(), cross_matrix(-point);
  return by_motion;
}

Vector6d difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d a_from_b = a.inverse() * b;
  const Eigen::AngleAxisd turn(a_from_b.linear());
  Vector6d motion;
  motion << a_from_b.translation(), turn.angle() * turn.axis();
  return motion;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& a, const Vector6d& motion) {
  const Eigen::Vector3d turn = motion.tail<3>();
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  if (const double angle = turn.norm(); angle > 0.0)
    step.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  step.translation() = motion.head<3>();
  return a * step;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace clearway
