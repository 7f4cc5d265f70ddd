#include "datasets/ros/ros_messages.hpp"

namespace clearway {
namespace {

template <std::size_t count>
std::array<double, count> read_array(WireReader& in) {
  std::array<double, count> numbers;
  for (double& number : numbers) number = in.number<double>();
  return numbers;
}

Eigen::Vector3d read_vector(WireReader& in) {
  const auto [x, y, z] = read_array<3>(in);
  return {x, y, z};
}

/// A frame's name, as tf2 has it.
std::string read_frame(WireReader& in) {
  std::string name = in.text();
  if (name.starts_with('/')) name.erase(0, 1);
  return name;
}

void read_place(WireReader& in, RosTransform& transform) {
  transform.translation = read_vector(in);
  const auto [x, y, z, w] = read_array<4>(in);
  transform.rotation = Eigen::Quaterniond(w, x, y, z);
}

}  // namespace

std::string short_type(std::string_view type) {
  std::string result(type);
  if (const auto at = result.find("/msg/"); at != std::string::npos) result.erase(at, 4);
  return result;
}

RosHeader read_header(WireReader& in) {
  if (in.wire() == RosWire::ros1) in.number<std::uint32_t>();  // of the sequence
  RosHeader header;
  const auto seconds = in.number<std::uint32_t>();  // unsigned in ROS 1 alone
  const auto nanoseconds = in.number<std::uint32_t>();
  header.time = in.wire() == RosWire::ros1 ? static_cast<double>(seconds)
                                           : static_cast<double>(static_cast<std::int32_t>(seconds));
  header.time += 1e-9 * nanoseconds;
  header.frame = in.text();
  if (header.frame.starts_with('/')) header.frame.erase(0, 1);  // tf's first version
  return header;
}

RosImage read_image(WireReader& in) {
  RosImage image;
  image.header = read_header(in);
  image.height = in.number<std::uint32_t>();
  image.width = in.number<std::uint32_t>();
  image.encoding = in.text();
  image.is_bigendian = in.number<std::uint8_t>() != 0;
  image.step = in.number<std::uint32_t>();
  image.data = in.bytes();
  return image;
}

RosCompressedImage read_compressed_image(WireReader& in) {
  RosCompressedImage image;
  image.header = read_header(in);
  image.format = in.text();
  image.data = in.bytes();
  return image;
}

RosCameraInfo read_camera_info(WireReader& in) {
  RosCameraInfo info;
  info.header = read_header(in);
  info.height = in.number<std::uint32_t>();
  info.width = in.number<std::uint32_t>();
  info.distortion_model = in.text();
  info.d = in.numbers<double>();
  info.k = read_array<9>(in);
  info.r = read_array<9>(in);
  info.p = read_array<12>(in);
  for (std::uint32_t* number :
       {&info.binning_x, &info.binning_y, &info.roi_x, &info.roi_y, &info.roi_height, &info.roi_width})
    *number = in.number<std::uint32_t>();
  info.do_rectify = in.number<std::uint8_t>() != 0;
  return info;
}

RosPointCloud read_point_cloud(WireReader& in) {
  RosPointCloud cloud;
  cloud.header = read_header(in);
  cloud.height = in.number<std::uint32_t>();
  cloud.width = in.number<std::uint32_t>();
  constexpr std::size_t least_field = 13;  // bytes
  for (std::size_t left = in.length(least_field); left > 0; --left) {
    RosPointField field;
    field.name = in.text();
    field.offset = in.number<std::uint32_t>();
    field.datatype = in.number<std::uint8_t>();
    field.count = in.number<std::uint32_t>();
    cloud.fields.push_back(std::move(field));
  }
  cloud.is_bigendian = in.number<std::uint8_t>() != 0;
  cloud.point_step = in.number<std::uint32_t>();
  cloud.row_step = in.number<std::uint32_t>();
  cloud.data = in.bytes();
  return cloud;
}

bool is_livox_cloud(std::string_view short_type) {
  return short_type == "livox_ros_driver/CustomMsg" || short_type == "livox_ros_driver2/CustomMsg" ||
         short_type == "livox_interfaces/CustomMsg";
}

/// A point is offset_time, x, y, z, and three numbers of a byte. CDR aligns the next one to four bytes, and
/// the last one ends before that: there a point counts from four bytes before it, where the length or the
/// three are.
RosPointCloud read_livox_cloud(WireReader& in) {
  RosPointCloud cloud;
  cloud.header = read_header(in);
  in.number<std::uint64_t>();                             // the stamp once more
  in.number<std::uint32_t>();                             // the number of points
  for (int i = 0; i < 4; ++i) in.number<std::uint8_t>();  // the lidar's, and three for later
  const bool is_packed = in.wire() == RosWire::ros1;
  const std::span<const std::uint8_t> from_length = in.left();
  const std::size_t count = in.length(19);
  const std::uint32_t before = is_packed ? 0 : 4;
  cloud.point_step = is_packed ? 19 : 20;
  if (in.left().size() + (is_packed ? 0 : 1) < count * cloud.point_step) throw CutMessage();
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(count);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_bigendian = in.is_bigendian();
  cloud.data = from_length.subspan(4 - before, count * cloud.point_step);
  cloud.fields = {{"offset_time", before, 1, 6},
                  {"x", before + 4, 1, 7},
                  {"y", before + 8, 1, 7},
                  {"z", before + 12, 1, 7}};
  return cloud;
}

RosLaserScan read_laser_scan(WireReader& in) {
  RosLaserScan scan;
  scan.header = read_header(in);
  for (float* number : {&scan.angle_min, &scan.angle_max, &scan.angle_increment, &scan.time_increment,
                        &scan.scan_time, &scan.range_min, &scan.range_max})
    *number = in.number<float>();
  scan.ranges = in.numbers<float>();
  return scan;
}

RosJointState read_joint_state(WireReader& in) {
  RosJointState state;
  state.header = read_header(in);
  for (std::size_t left = in.length(4); left > 0; --left) state.names.push_back(in.text());
  state.positions = in.numbers<double>();
  return state;
}

RosTransform read_pose(WireReader& in, std::string_view short_type) {
  RosTransform pose;
  pose.header = read_header(in);
  if (short_type == "nav_msgs/Odometry" || short_type == "geometry_msgs/TransformStamped")
    pose.child = read_frame(in);
  read_place(in, pose);
  return pose;
}

std::vector<RosTransform> read_path(WireReader& in) {
  const RosHeader path = read_header(in);
  std::vector<RosTransform> poses;
  constexpr std::size_t least_pose = 68;  // bytes
  for (std::size_t left = in.length(least_pose); left > 0; --left) {
    RosTransform pose;
    pose.header = read_header(in);
    if (pose.header.frame.empty()) pose.header.frame = path.frame;
    read_place(in, pose);
    poses.push_back(std::move(pose));
  }
  return poses;
}

std::vector<RosTransform> read_transforms(WireReader& in) {
  std::vector<RosTransform> transforms;
  constexpr std::size_t least_transform = 72;  // bytes
  for (std::size_t left = in.length(least_transform); left > 0; --left) {
    RosTransform transform;
    transform.header = read_header(in);
    transform.child = read_frame(in);
    read_place(in, transform);
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

}  // namespace clearway
