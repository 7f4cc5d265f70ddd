#pragma once

#include <Eigen/Geometry>

namespace clearway {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix36d = Eigen::Matrix<double, 3, 6>;

/// A rigid transform `a_from_b` with a Gaussian error.
///
/// The covariance belongs to the small motion (v, w) of frame b seen in b itself: true pose =
/// a_from_b * [Exp(w), v]; first the three of translation (metres), then the three of rotation (radians).
/// So it does not depend on where frame a lies, and no angle convention can make it singular.
struct UncertainPose {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

/// A point with its covariance, m^2, in the frame the point is given in.
struct UncertainPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  /// Standard deviation along the worst direction, metres.
  double largest_sigma() const;
};

/// b_from_a of a_from_b. The poses are MRPT's; the error is carried to first order by the adjoint. MRPT 2.5.8
/// carries covariances through unit quaternions and forgets that it turns their sign: where the real part of
/// a quaternion or of a product comes out negative, translation and rotation get the wrong correlation.
UncertainPose inverse(const UncertainPose& a_from_b);

/// a_from_c = a_from_b * b_from_c of independent errors, carried likewise.
UncertainPose compose(const UncertainPose& a_from_b, const UncertainPose& b_from_c);

/// Eq. 1 of Chong et al. 2008: base_from_probe = base_from_camera * camera_from_probe, from the two poses
/// that one image gives. Their errors are taken as independent (pixel noise is; a wrong calibration is not).
UncertainPose base_from_probe(const UncertainPose& camera_from_base, const UncertainPose& camera_from_probe);

/// `a_from_b * point` for an exactly known point of frame b (the W_T_W' of Chong 2008, eq. 1: the ball's
/// centre).
UncertainPoint transform(const UncertainPose& a_from_b, const Eigen::Vector3d& point);

/// The small motion (v, w) with b = a * [Exp(w), v].
Vector6d difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// a * [Exp(w), v].
Eigen::Isometry3d moved(const Eigen::Isometry3d& a, const Vector6d& motion);

/// How a small motion (v, w) of frame b enters one of frame a.
Matrix6d adjoint(const Eigen::Isometry3d& a_from_b);

/// A covariance of small motions of frame b, as one of frame a.
Matrix6d carried(const Eigen::Isometry3d& a_from_b, const Matrix6d& covariance_in_b);

/// How a point given in a frame moves, seen in that frame, by a small motion (v, w) of it: (1, -[point]x).
Matrix36d point_by_motion(const Eigen::Vector3d& point);

/// The matrix [v]x with [v]x u = v x u.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

}  // namespace clearway
