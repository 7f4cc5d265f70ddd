#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "datasets/bags/mcap_writer.hpp"
#include "tests/worlds/bags/ros1_bag_writer.hpp"

namespace clearway::worlds {

/// The fields of a message in CDR or in ROS 1's encoding, put into bytes here a second time.
class MessageBytes {
 public:
  explicit MessageBytes(bool is_ros1) : is_ros1_(is_ros1) {
    if (!is_ros1) bytes_.assign("\0\1\0\0", 4);
  }
  template <class Number>
  MessageBytes& add(Number number) {
    while (!is_ros1_ && (bytes_.size() - 4) % sizeof(Number) != 0) bytes_.push_back('\0');
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    return *this;
  }
  MessageBytes& text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + (is_ros1_ ? 0 : 1))).bytes_ += text;
    if (!is_ros1_) bytes_.push_back('\0');
    return *this;
  }
  template <class Numbers>
  MessageBytes& all(const Numbers& numbers) {
    for (const auto& number : numbers) add(number);
    return *this;
  }
  template <class Numbers>
  MessageBytes& list(const Numbers& numbers) {
    return add(static_cast<std::uint32_t>(numbers.size())).all(numbers);
  }
  MessageBytes& header(double time, const std::string& frame) {
    if (is_ros1_) add(std::uint32_t{7});  // of the sequence
    const double seconds = std::floor(time);
    add(static_cast<std::uint32_t>(static_cast<std::int64_t>(seconds)));
    return add(static_cast<std::uint32_t>((time - seconds) * 1e9 + 0.5)).text(frame);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool is_ros1_;
  std::string bytes_;
};

/// A CameraInfo of a sensor, of which a part may be read out and binned.
struct BagCameraInfo {
  std::uint32_t width = 0, height = 0;
  std::string model = "plumb_bob";
  std::vector<double> d;
  std::array<double, 9> k{}, r{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  std::array<std::uint32_t, 4> roi{};  ///< x, y, height, width
};

/// A bag of images and their cameras: MCAP (CDR) or a ROS 1 bag, as its file's name ends.
class CameraBag {
 public:
  explicit CameraBag(const std::filesystem::path& file) : file_(file), is_ros1_(file.extension() == ".bag") {}

  void info(const std::string& topic, double time, const std::string& frame, const BagCameraInfo& info) {
    MessageBytes out(is_ros1_);
    out.header(time, frame).add(info.height).add(info.width).text(info.model).list(info.d);
    out.all(info.k).all(info.r).all(info.p).add(info.binning_x).add(info.binning_y).all(info.roi);
    out.add(std::uint8_t{1});
    add("CameraInfo", topic, time, out);
  }
  /// @param pixels of one or two bytes ("mono8", "16UC1"), row by row
  template <class Pixel>
  void image(const std::string& topic, double time, const std::string& frame, const std::string& encoding,
             std::uint32_t width, const std::vector<Pixel>& pixels) {
    MessageBytes out(is_ros1_);
    out.header(time, frame).add(static_cast<std::uint32_t>(pixels.size() / width)).add(width).text(encoding);
    out.add(std::uint8_t{0}).add(static_cast<std::uint32_t>(width * sizeof(Pixel)));
    std::vector<std::uint8_t> data(pixels.size() * sizeof(Pixel));
    std::memcpy(data.data(), pixels.data(), data.size());
    add("Image", topic, time, out.list(data));
  }
  /// A std_msgs/Float32.
  void number(const std::string& topic, double time, float value) {
    MessageBytes out(is_ros1_);
    out.add(value);
    records_.push_back({topic, is_ros1_ ? "std_msgs/Float32" : "std_msgs/msg/Float32", time, out.bytes()});
  }
  /// Where a frame stands in "map". @param turn x, y, z, w
  void place(const std::string& frame, double time, const std::array<double, 3>& translation,
             const std::array<double, 4>& turn) {
    MessageBytes out(is_ros1_);
    out.add(std::uint32_t{1}).header(time, "map").text(frame).all(translation).all(turn);
    records_.push_back(
        {"/tf_static", is_ros1_ ? "tf2_msgs/TFMessage" : "tf2_msgs/msg/TFMessage", time, out.bytes()});
  }
  void write() const { write_bag(file_, records_, is_ros1_); }

 private:
  void add(const std::string& type, const std::string& topic, double time, const MessageBytes& message) {
    records_.push_back(
        {topic, (is_ros1_ ? "sensor_msgs/" : "sensor_msgs/msg/") + type, time, message.bytes()});
  }

  std::filesystem::path file_;
  bool is_ros1_;
  std::vector<BagRecord> records_;
};

}  // namespace clearway::worlds
