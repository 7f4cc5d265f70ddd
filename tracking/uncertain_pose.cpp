#include "tracking/uncertain_pose.hpp"

#include <mrpt/poses/CPose3DQuatPDFGaussian.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

using mrpt::poses::CPose3DQuat;
using mrpt::poses::CPose3DQuatPDFGaussian;

// d(qr, qx, qy, qz)/dw for q * (1, w/2).
Eigen::Matrix<double, 4, 3> quaternion_by_turn(const Eigen::Quaterniond& q) {
  Eigen::Matrix<double, 4, 3> j;
  j.row(0) = -0.5 * q.vec().transpose();
  j.bottomRows<3>() = 0.5 * (q.w() * Eigen::Matrix3d::Identity() + cross_matrix(q.vec()));
  return j;
}

// MRPT's seven: x y z, then the quaternion (r x y z), all in frame a.
CPose3DQuatPDFGaussian to_mrpt(const UncertainPose& in) {
  const Eigen::Quaterniond q(in.pose.linear());
  const Eigen::Vector3d t = in.pose.translation();
  Eigen::Matrix<double, 7, 6> seven_by_six = Eigen::Matrix<double, 7, 6>::Zero();
  seven_by_six.topLeftCorner<3, 3>() = in.pose.linear();
  seven_by_six.bottomRightCorner<4, 3>() = quaternion_by_turn(q);
  CPose3DQuatPDFGaussian out(
      CPose3DQuat(t.x(), t.y(), t.z(), mrpt::math::CQuaternionDouble(q.w(), q.x(), q.y(), q.z())));
  out.cov = mrpt::math::CMatrixDouble77((seven_by_six * in.covariance * seven_by_six.transpose()).eval());
  return out;
}

UncertainPose from_mrpt(const CPose3DQuatPDFGaussian& in) {
  const auto& m = in.mean;
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(m.quat().r(), m.quat().x(), m.quat().y(), m.quat().z()).normalized();
  UncertainPose out;
  out.pose.linear() = q.toRotationMatrix();
  out.pose.translation() = Eigen::Vector3d(m.x(), m.y(), m.z());
  Eigen::Matrix<double, 6, 7> six_by_seven = Eigen::Matrix<double, 6, 7>::Zero();
  six_by_seven.topLeftCorner<3, 3>() = out.pose.linear().transpose();
  six_by_seven.bottomRightCorner<3, 4>() = 4.0 * quaternion_by_turn(q).transpose();  // its pseudo-inverse
  const Matrix6d covariance = six_by_seven * in.cov.asEigen() * six_by_seven.transpose();
  out.covariance = 0.5 * (covariance + covariance.transpose());
  return out;
}

}  // namespace

double UncertainPoint::largest_sigma() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

UncertainPose inverse(const UncertainPose& a_from_b) { return from_mrpt(-to_mrpt(a_from_b)); }

UncertainPose compose(const UncertainPose& a_from_b, const UncertainPose& b_from_c) {
  return from_mrpt(to_mrpt(a_from_b) + to_mrpt(b_from_c));
}

UncertainPose base_from_probe(const UncertainPose& camera_from_base, const UncertainPose& camera_from_probe) {
  const UncertainPose base_from_camera = inverse(camera_from_base);
  return compose(base_from_camera, camera_from_probe);
}

UncertainPoint transform(const UncertainPose& a_from_b, const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 3, 6> by_motion;
  by_motion << Eigen::Matrix3d::Identity(), -cross_matrix(point);
  by_motion = a_from_b.pose.linear() * by_motion;
  return {a_from_b.pose * point, by_motion * a_from_b.covariance * by_motion.transpose()};
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
