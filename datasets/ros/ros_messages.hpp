#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/ros/wire_reader.hpp"

// The messages of ROS that Clearway has a use for, with the fields that it uses, as common_interfaces,
// geometry2 and Livox's drivers define them. Each function throws std::runtime_error with a clause where the
// bytes are no such message. Numbers are as they stand in the message: what makes sense is asked where they
// are used.

namespace clearway {

/// "sensor_msgs/Image" of "sensor_msgs/msg/Image" and of itself.
std::string short_type(std::string_view type);

struct RosHeader {
  double time = 0;  ///< s
  std::string frame;
};
RosHeader read_header(WireReader& in);  ///< with which messages of sensors begin

constexpr std::uint32_t most_image_side = 20'000;  ///< pixels

struct RosImage {
  RosHeader header;
  std::uint32_t height = 0, width = 0, step = 0;  ///< step: bytes of a row
  std::string encoding;
  bool is_bigendian = false;
  std::span<const std::uint8_t> data;  ///< of the message
};
RosImage read_image(WireReader& in);

struct RosCompressedImage {
  RosHeader header;
  std::string format;
  std::span<const std::uint8_t> data;  ///< of the message
};
RosCompressedImage read_compressed_image(WireReader& in);

struct RosCameraInfo {
  RosHeader header;
  std::uint32_t height = 0, width = 0;  ///< of the whole sensor, as are k and p
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;  ///< pixels of the sensor in one of the image; 0: 1
  std::uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;  ///< read out; 0 x 0: all
  bool do_rectify = false;  ///< of the region of interest: rectified images show another window than it
};
RosCameraInfo read_camera_info(WireReader& in);

struct RosPointField {
  std::string name;
  std::uint32_t offset = 0, count = 0;
  std::uint8_t datatype = 0;  ///< 1 to 8: int8, uint8, int16, uint16, int32, uint32, float32, float64
};
struct RosPointCloud {
  RosHeader header;
  std::uint32_t height = 0, width = 0, point_step = 0, row_step = 0;
  std::vector<RosPointField> fields;
  bool is_bigendian = false;
  std::span<const std::uint8_t> data;  ///< of the message
};
RosPointCloud read_point_cloud(WireReader& in);
/// Livox's own message, as a cloud with the fields x, y, z (float32) and offset_time (uint32, ns).
RosPointCloud read_livox_cloud(WireReader& in);
bool is_livox_cloud(std::string_view short_type);

struct RosLaserScan {
  RosHeader header;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0, range_min = 0,
        range_max = 0;
  std::vector<float> ranges;
};
RosLaserScan read_laser_scan(WireReader& in);

struct RosJointState {
  RosHeader header;
  std::vector<std::string> names;
  std::vector<double> positions;
};
RosJointState read_joint_state(WireReader& in);

struct RosTransform {
  RosHeader header;  ///< its frame is the parent
  std::string child;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};
std::vector<RosTransform> read_transforms(WireReader& in);  ///< of tf2_msgs/TFMessage and tf/tfMessage
/// A pose of its own: nav_msgs/Odometry, geometry_msgs/TransformStamped, PoseStamped or
/// PoseWithCovarianceStamped. The last two do not say what the pose is of: `child` is empty.
RosTransform read_pose(WireReader& in, std::string_view short_type);
/// The poses of a nav_msgs/Path, each with a time and, unless its own header names one, in the path's frame.
/// What they are of it does not say: `child` is empty.
std::vector<RosTransform> read_path(WireReader& in);

}  // namespace clearway
