#pragma once

#include "tracking/tag_body.hpp"

namespace clearway {

/// How far a point, such as the probe's ball, may be from where it was found, metres: in 99.9 % of cases,
/// when the errors are what the setup states. The parts are bounds of their own; as independent errors they
/// add up to `total` in squares or less.
struct CenterBound {
  double total = 0.0;
  double noise = 0.0;   ///< of the corners, as large as the residuals show it
  double tilt = 0.0;    ///< what barely observable turns add to `noise` (see BodyPose::limits)
  double camera = 0.0;  ///< calibration: focal length, centre, distortion
  double tags = 0.0;    ///< sizes and places of both bodies' tags
  double edges = 0.0;   ///< the detector's bias
};

/// The bound of `ball` (metres, in the probe) seen from the base, by Chong 2008, eq. 1, whose errors are
/// carried to first order; the calibration's, which both bodies share, with their signs. `camera_from_base`
/// is the base's pose that is used: `base.camera_from_body`, or its mean over time, whose noise is then the
/// mean's. `noise_freedom` as in BodyPoseOptions.
CenterBound bound_center(const BodyPose& base, const UncertainPose& camera_from_base, bool is_mean,
                         const BodyPose& probe, const Eigen::Vector3d& ball, int noise_freedom);

/// The same of a `point` of one body (metres, in its frame), seen from the camera.
CenterBound bound_point(const BodyPose& body, const Eigen::Vector3d& point, int noise_freedom);

/// The same of the camera's own place, seen from the body.
CenterBound bound_camera(const BodyPose& body, int noise_freedom);

}  // namespace clearway
