#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/ros_messages.hpp"
#include "datasets/sources/recording.hpp"

// Cameras of CameraInfo messages, as sensor_msgs defines them and image_geometry reads them: a raw image
// follows K and D, a rectified one P alone; R leads from the raw camera's axes to the rectified ones, which
// are those of the frame that headers name.

namespace clearway {

/// A camera, and its axes (x right, y down, z forward) in the frame that the headers of its images name.
struct RosCamera {
  CameraIntrinsics intrinsics;
  Eigen::Matrix3d frame_from_camera = Eigen::Matrix3d::Identity();
};

/// The camera of raw images: K, D and R. The distortion models are plumb_bob, rational_polynomial,
/// equidistant (fisheye), and any other whose numbers are all 0. As in image_geometry, the region of interest
/// is taken off the principal point first, then binning divides: size, focal lengths and principal point are
/// those of the images. R is taken for the nearest
/// rotation, from which rounding to four decimals may lead away. @throws std::runtime_error with a clause
/// where the message is no calibration
RosCamera raw_camera(const RosCameraInfo& info);

/// The camera of rectified images: P, without distortion; D is that of the raw lens and counts for nothing. A
/// P of which all is 0 is K where the lens has no distortion and R is no turn, and refused elsewhere: nothing
/// says then what the images follow. P's last column, which places the second camera of a pair in the frame
/// of the first, is left out, as in depth_image_proc. A part of the image with do_rectify is refused: its
/// window is not stated. @throws as raw_camera
RosCamera rectified_camera(const RosCameraInfo& info);

}  // namespace clearway
