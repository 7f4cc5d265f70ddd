#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

// Messages of ROS 2 in CDR, as McapWriter takes them, and the definitions that stand beside them (ros2msg).

namespace clearway {

/// A type's name and the text of its definition, those of its parts behind it.
struct RosType {
  std::string name;  ///< "sensor_msgs/msg/PointCloud2"
  std::string definition;
};
const RosType& point_cloud_type();
const RosType& transforms_type();  ///< tf2_msgs/msg/TFMessage
const RosType& pose_type();        ///< geometry_msgs/msg/PoseWithCovarianceStamped
const RosType& camera_info_type();
const RosType& joint_state_type();
const RosType& joint_trajectory_type();

/// A cloud of float32 x, y, z, in metres, and one number more of each point where `extra` names it.
std::string encode_points(double time, const std::string& frame, std::span<const Eigen::Vector3f> points,
                          const std::string& extra = "", std::span<const float> numbers = {});

/// Where frames are in another one, at one time.
struct PlacedFrame {
  std::string name;
  Eigen::Isometry3d parent_from_frame = Eigen::Isometry3d::Identity();
};
std::string encode_transforms(double time, const std::string& parent, std::span<const PlacedFrame> frames);

/// @param covariance of x, y, z and the turns about the axes x, y, z of `frame`, m and rad
std::string encode_pose(double time, const std::string& frame, const Eigen::Isometry3d& pose,
                        const Eigen::Matrix<double, 6, 6>& covariance);

/// R is no turn, and P is K: no rectified image belongs to it.
std::string encode_camera_info(double time, const std::string& frame, const CameraIntrinsics& camera);

std::string encode_joints(double time, const std::vector<std::string>& names,
                          const Eigen::VectorXd& positions);

/// @param points seconds since the start, positions, velocities
struct TimedPosition {
  double time = 0;
  Eigen::VectorXd position, velocity;
};
std::string encode_trajectory(double time, const std::vector<std::string>& names,
                              std::span<const TimedPosition> points);

}  // namespace clearway
