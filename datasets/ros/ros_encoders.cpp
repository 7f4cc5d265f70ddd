#include "datasets/ros/ros_encoders.hpp"

#include <cmath>
#include <cstring>

#include "datasets/ros/wire_writer.hpp"
#include "datasets/sources/lens.hpp"

namespace clearway {
namespace {

/// A part's definition behind the others.
std::string part(const std::string& name, const std::string& fields) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + fields;
}

const std::string time_fields = "int32 sec\nuint32 nanosec\n";

std::string header_parts() {
  return part("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
         part("builtin_interfaces/Time", time_fields);
}

void put_duration(double seconds, WireWriter& out) {
  const double whole = std::floor(seconds);
  auto nanoseconds = static_cast<std::uint32_t>(std::llround((seconds - whole) * 1e9));
  const bool carries = nanoseconds >= 1'000'000'000U;
  out.number(static_cast<std::int32_t>(whole) + (carries ? 1 : 0));
  out.number(carries ? 0U : nanoseconds);
}

WireWriter with_header(double time, const std::string& frame) {
  WireWriter out;
  put_duration(time, out);
  out.text(frame);
  return out;
}

void put_pose(const Eigen::Isometry3d& pose, WireWriter& out) {
  for (int axis = 0; axis < 3; ++axis) out.number(pose.translation()[axis]);
  const Eigen::Quaterniond rotation(pose.linear());
  for (int i = 0; i < 4; ++i) out.number(rotation.coeffs()[i]);
}

/// What CameraInfo calls a lens.
std::string ros_name(LensModel lens) {
  if (lens == LensModel::rational) return "rational_polynomial";
  return lens == LensModel::fisheye ? "equidistant" : "plumb_bob";
}

const std::string quaternion_part =
    part("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");

void put_texts(const std::vector<std::string>& texts, WireWriter& out) {
  out.length(texts.size());
  for (const std::string& text : texts) out.text(text);
}

}  // namespace

const RosType& point_cloud_type() {
  static const RosType type{
      "sensor_msgs/msg/PointCloud2",
      "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool "
      "is_bigendian\n"
      "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
          header_parts() +
          part("sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n")};
  return type;
}

const RosType& transforms_type() {
  static const RosType type{
      "tf2_msgs/msg/TFMessage",
      "geometry_msgs/TransformStamped[] transforms\n" +
          part("geometry_msgs/TransformStamped",
               "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n") +
          header_parts() +
          part("geometry_msgs/Transform",
               "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n") +
          part("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n") + quaternion_part};
  return type;
}

const RosType& pose_type() {
  static const RosType type{
      "geometry_msgs/msg/PoseWithCovarianceStamped",
      "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n" + header_parts() +
          part("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n") +
          part("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n") +
          part("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n") + quaternion_part};
  return type;
}

const RosType& camera_info_type() {
  static const RosType type{
      "sensor_msgs/msg/CameraInfo",
      "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
      "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
      "sensor_msgs/RegionOfInterest roi\n" +
          header_parts() +
          part("sensor_msgs/RegionOfInterest",
               "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n")};
  return type;
}

const RosType& joint_state_type() {
  static const RosType type{"sensor_msgs/msg/JointState",
                            "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
                            "float64[] effort\n" +
                                header_parts()};
  return type;
}

const RosType& joint_trajectory_type() {
  static const RosType type{
      "trajectory_msgs/msg/JointTrajectory",
      "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points\n" +
          header_parts() +
          part("trajectory_msgs/JointTrajectoryPoint",
               "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n"
               "builtin_interfaces/Duration time_from_start\n") +
          part("builtin_interfaces/Duration", time_fields)};
  return type;
}

std::string encode_points(double time, const std::string& frame, std::span<const Eigen::Vector3f> points,
                          const std::string& extra, std::span<const float> numbers) {
  WireWriter out = with_header(time, frame);
  std::vector<std::string> fields{"x", "y", "z"};
  if (!extra.empty()) fields.push_back(extra);
  const std::size_t step = 4 * fields.size();
  out.number(std::uint32_t{1});
  out.length(points.size());
  out.length(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    constexpr std::uint8_t float32 = 7;
    out.text(fields[i]);
    out.length(4 * i);
    out.number(float32);
    out.number(std::uint32_t{1});
  }
  out.number(std::uint8_t{0});
  out.length(step);
  out.length(step * points.size());
  std::vector<std::uint8_t> data(step * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&data[step * i], points[i].data(), 12);
    if (!extra.empty()) std::memcpy(&data[step * i + 12], &numbers[i], 4);
  }
  out.bytes(data);
  out.number(std::uint8_t{1});
  return out.message();
}

std::string encode_transforms(double time, const std::string& parent, std::span<const PlacedFrame> frames) {
  WireWriter out;
  out.length(frames.size());
  for (const PlacedFrame& frame : frames) {
    put_duration(time, out);
    out.text(parent);
    out.text(frame.name);
    put_pose(frame.parent_from_frame, out);
  }
  return out.message();
}

std::string encode_pose(double time, const std::string& frame, const Eigen::Isometry3d& pose,
                        const Eigen::Matrix<double, 6, 6>& covariance) {
  WireWriter out = with_header(time, frame);
  put_pose(pose, out);
  for (int i = 0; i < 36; ++i) out.number(covariance(i / 6, i % 6));
  return out.message();
}

std::string encode_camera_info(double time, const std::string& frame, const CameraIntrinsics& camera) {
  WireWriter out = with_header(time, frame);
  out.length(static_cast<std::size_t>(camera.height));
  out.length(static_cast<std::size_t>(camera.width));
  out.text(ros_name(camera.lens));
  out.numbers(coefficients_of(camera));
  for (const double k : {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0}) out.number(k);
  for (int i = 0; i < 9; ++i) out.number(i % 4 == 0 ? 1.0 : 0.0);
  for (const double p : {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    out.number(p);
  for (int i = 0; i < 6; ++i) out.number(std::uint32_t{0});  // of binning and region of interest: all is read
  out.number(std::uint8_t{0});
  return out.message();
}

std::string encode_joints(double time, const std::vector<std::string>& names,
                          const Eigen::VectorXd& positions) {
  WireWriter out = with_header(time, "");
  put_texts(names, out);
  out.numbers(positions);
  out.length(0);
  out.length(0);
  return out.message();
}

std::string encode_trajectory(double time, const std::vector<std::string>& names,
                              std::span<const TimedPosition> points) {
  WireWriter out = with_header(time, "");
  put_texts(names, out);
  out.length(points.size());
  for (const TimedPosition& point : points) {
    out.numbers(point.position);
    out.numbers(point.velocity);
    out.length(0);
    out.length(0);
    put_duration(point.time, out);
  }
  return out.message();
}

}  // namespace clearway
