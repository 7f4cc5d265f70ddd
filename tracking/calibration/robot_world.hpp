#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tracking/tag_body.hpp"

namespace clearway {

/// One image of a robot that stands still. What rides on its tip, a board or the camera, is known twice: by
/// the joints and by the tags. world_from_base * base_from_tip * tip_from_rider = world_from_rider.
struct RobotLook {
  Eigen::Isometry3d base_from_tip = Eigen::Isometry3d::Identity();  ///< by joints and kinematics
  UncertainPose world_from_rider;                                   ///< by tags; covariance: corners alone
  Eigen::Matrix<double, 6, kCameraModes> by_camera = Eigen::Matrix<double, 6, kCameraModes>::Zero();
  Matrix6d tags_of_world = Matrix6d::Zero();  ///< what tags' errors move in the world's own frame
  Matrix6d tags_of_rider = Matrix6d::Zero();  ///< the same of the rider
  /// How the tip moves, in its own frame, for an offset of each joint that RobotWorldOptions::joints names;
  /// of no columns when it names none.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_joints{};
};

/// A board on the tip before a camera. The world is the frame in which `world_from_board` places a fixed
/// board of the same image, or without `fixed` the camera, which has to stand still.
RobotLook look_at_tip(const Eigen::Isometry3d& base_from_tip, const BodyPose& on_tip,
                      const std::optional<BodyPose>& fixed,
                      const Eigen::Isometry3d& world_from_board = Eigen::Isometry3d::Identity());

/// A camera on the tip that sees a fixed board.
RobotLook look_from_tip(const Eigen::Isometry3d& base_from_tip, const BodyPose& fixed,
                        const Eigen::Isometry3d& world_from_board);

struct RobotWorldOptions {
  std::size_t least_looks = 10;
  double least_turn = 0.35;  ///< radians, of the tip about a second axis
  double tip_error = 1e-3;   ///< metres along each axis: how far the robot may be from what its joints say
  double tip_turn = 2e-3;    ///< radians about each axis, likewise
  /// Joints whose readings may be off by the same in all looks. Not the first and the last of the arm: their
  /// offsets are the base's and the rider's place, and cancel out where both are used with those readings.
  std::vector<std::string> joints = {};
  double joint_error = 0.01;    ///< radians or metres: one standard deviation of such an offset
  double most_sigma = 0.005;    ///< metres, of the tips' middle by base_as_used and of the rider on it
  double most_residual = 0.01;  ///< metres, of a look that took no part
};

struct RobotWorldCalibration {
  std::string refusal;            ///< one sentence; empty: it is good
  UncertainPose world_from_base;  ///< of the robot's base in the world
  UncertainPose tip_from_rider;
  /// The same again, with covariances that leave out offsets of joints: how well is known where readings
  /// with the same offsets put the arm, near where it was looked at.
  UncertainPose base_as_used, rider_as_used;
  double rms = 0.0, rms_turn = 0.0;            ///< metres, radians: of the rider's places
  double left_out = 0.0, left_out_turn = 0.0;  ///< the same of each look by a fit from all others
  double scale = 1.0, scale_sigma = 0.0;       ///< true over stated size of the tags, by the robot's motion
  double turn = 0.0;                           ///< radians, between the two looks that differ most
  double second_turn = 0.0;                    ///< radians, about the axis across that one
  std::vector<double> offsets, offset_sigmas;  ///< of RobotWorldOptions::joints, as the looks show them
  std::size_t looks = 0, contradicted = 0;
};

/// Where a robot stands and what its tip carries: OpenCV's robot-world solver (Shah 2013) starts a weighted
/// least squares over both poses (the covariance of each look is that of its corners and of the robot's tip,
/// enlarged to what the residuals show). Looks that contradict the others are left out, a third at most. The
/// covariances also count what all looks share: errors of the camera with their signs, of tags as one look
/// has them, and offsets of joints, as large as the looks leave open or show them to be. An offset above
/// three times joint_error is refused by name.
RobotWorldCalibration calibrate_robot_world(const std::vector<RobotLook>& looks,
                                            const RobotWorldOptions& options = {});

}  // namespace clearway
