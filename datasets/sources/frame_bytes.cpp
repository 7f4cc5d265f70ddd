#include "datasets/sources/frame_bytes.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace clearway {
namespace {

class ByteWriter {
 public:
  template <class T>
  void number(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void block(const void* data, size_t size) {
    number<uint64_t>(size);
    bytes.append(static_cast<const char*>(data), size);
  }
  void pose(const Eigen::Isometry3d& pose) {
    for (int i = 0; i < 16; ++i) number(pose.matrix().data()[i]);
  }
  std::string bytes;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    if constexpr (std::is_floating_point_v<T>) require(std::isfinite(value));
    return value;
  }
  std::string_view block() { return take(number<uint64_t>()); }
  Eigen::Isometry3d pose() {
    Eigen::Isometry3d pose;
    for (int i = 0; i < 16; ++i) pose.matrix().data()[i] = number<double>();
    const Eigen::Matrix3d rotation = pose.linear();
    require((rotation * rotation.transpose()).isIdentity(1e-6) && rotation.determinant() > 0);
    require(pose.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1));
    return pose;
  }
  static void require(bool claim) {
    if (!claim) throw std::runtime_error("a decoded frame does not make sense");
  }
  void end() const { require(bytes_.empty()); }

 private:
  std::string_view take(uint64_t size) {
    require(size <= bytes_.size());
    const auto part = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return part;
  }
  std::string_view bytes_;
};

void write_content(ByteWriter& out, const ImageFrame& frame) {
  out.number(frame.image.width);
  out.number(frame.image.height);
  out.block(frame.image.pixels.data(), frame.image.pixels.size());
  const auto& camera = frame.intrinsics;
  out.number(camera.width);
  out.number(camera.height);
  for (double value : {camera.fx, camera.fy, camera.cx, camera.cy}) out.number(value);
  for (double value : camera.distortion) out.number(value);
  out.number<uint8_t>(camera.is_rectified ? 1 : 0);
  out.number<uint8_t>(static_cast<uint8_t>(camera.lens));
  out.pose(frame.world_from_sensor);
}

void write_content(ByteWriter& out, const CloudFrame& frame) {
  out.block(frame.points.data(), frame.points.size() * sizeof(Eigen::Vector3f));
  out.pose(frame.world_from_sensor);
  out.number(frame.max_range);
  out.block(frame.kind.data(), frame.kind.size());
  out.number<std::uint64_t>(frame.unusable);
  out.number<std::uint64_t>(frame.infinite);
  out.number<std::uint64_t>(frame.at_range);
  out.number<uint8_t>(frame.is_origin_known ? 1 : 0);
  out.block(frame.clear_to.data(), frame.clear_to.size() * sizeof(Eigen::Vector3f));
  out.block(frame.times.data(), frame.times.size() * sizeof(float));
}

void write_content(ByteWriter& out, const OdometryFrame& frame) { out.pose(frame.world_from_robot); }

void write_content(ByteWriter& out, const CommentFrame& frame) {
  out.block(frame.text.data(), frame.text.size());
}

ImageFrame read_image(ByteReader& in) {
  ImageFrame frame;
  frame.image.width = in.number<int>();
  frame.image.height = in.number<int>();
  const auto pixels = in.block();
  in.require(frame.image.width > 0 && frame.image.height > 0 &&
             pixels.size() == static_cast<uint64_t>(frame.image.width) * frame.image.height);
  frame.image.pixels.assign(pixels.begin(), pixels.end());
  auto& camera = frame.intrinsics;
  camera.width = in.number<int>();
  camera.height = in.number<int>();
  for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = in.number<double>();
  for (double& value : camera.distortion) value = in.number<double>();
  const auto is_rectified = in.number<uint8_t>();
  in.require(is_rectified <= 1);
  camera.is_rectified = is_rectified == 1;
  const auto lens = in.number<uint8_t>();
  in.require(lens <= static_cast<uint8_t>(LensModel::fisheye));
  camera.lens = static_cast<LensModel>(lens);
  frame.world_from_sensor = in.pose();
  return frame;
}

std::vector<Eigen::Vector3f> read_points(ByteReader& in) {
  const auto bytes = in.block();
  in.require(bytes.size() % sizeof(Eigen::Vector3f) == 0);
  std::vector<Eigen::Vector3f> points(bytes.size() / sizeof(Eigen::Vector3f));
  if (!bytes.empty()) std::memcpy(points.data()->data(), bytes.data(), bytes.size());
  for (const auto& point : points) in.require(point.allFinite());
  return points;
}

/// Of as many points, or none.
std::vector<float> read_times(ByteReader& in, std::size_t points) {
  const auto bytes = in.block();
  in.require(bytes.empty() || bytes.size() == points * sizeof(float));
  std::vector<float> times(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(times.data(), bytes.data(), bytes.size());
  for (const float time : times) in.require(std::isfinite(time));
  return times;
}

CloudFrame read_cloud(ByteReader& in) {
  CloudFrame frame;
  frame.points = read_points(in);
  frame.world_from_sensor = in.pose();
  frame.max_range = in.number<double>();
  frame.kind = in.block();
  frame.unusable = in.number<std::uint64_t>();
  frame.infinite = in.number<std::uint64_t>();
  frame.at_range = in.number<std::uint64_t>();
  const auto is_known = in.number<uint8_t>();
  in.require(is_known <= 1);
  frame.is_origin_known = is_known == 1;
  frame.clear_to = read_points(in);
  frame.times = read_times(in, frame.points.size());
  return frame;
}

}  // namespace

std::string frame_to_bytes(const DecodedFrame& decoded) {
  ByteWriter out;
  const Frame& frame = decoded.frame;
  out.number(frame.time);
  out.block(frame.sensor.data(), frame.sensor.size());
  out.number<uint8_t>(decoded.posed);
  out.number<uint8_t>(static_cast<uint8_t>(frame.content.index()));
  std::visit([&out](const auto& content) { write_content(out, content); }, frame.content);
  return std::move(out.bytes);
}

DecodedFrame frame_from_bytes(std::string_view bytes) {
  ByteReader in(bytes);
  DecodedFrame decoded;
  decoded.frame.time = in.number<double>();
  decoded.frame.sensor = in.block();
  decoded.posed = in.number<uint8_t>() != 0;
  switch (in.number<uint8_t>()) {
    case 0:
      decoded.frame.content = read_image(in);
      break;
    case 1:
      decoded.frame.content = read_cloud(in);
      break;
    case 2:
      decoded.frame.content = OdometryFrame{in.pose()};
      break;
    case 3:
      decoded.frame.content = CommentFrame{std::string(in.block())};
      break;
    default:
      in.require(false);
  }
  in.end();
  return decoded;
}

}  // namespace clearway
