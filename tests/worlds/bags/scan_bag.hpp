#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "datasets/bags/mcap_writer.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/bags/ros1_bag_writer.hpp"

namespace clearway::worlds {

/// When a message was recorded, and the stamp in its header; one number: both.
struct BagTime {
  BagTime(double time) : recorded(time), stamp(time) {}  // NOLINT: a time is one
  BagTime(double recorded, double stamp) : recorded(recorded), stamp(stamp) {}
  double recorded, stamp;
};

/// A LaserScan but for its ranges.
struct BagSweep {
  float angle_min = 0, angle_increment = 0, time_increment = 0, range_max = 30;
};

/// A bag of what range sensors saw, and of transforms: MCAP (CDR) or a ROS 1 bag, as its file's name ends.
class ScanBag {
 public:
  explicit ScanBag(const std::filesystem::path& file) : file_(file), is_ros1_(file.extension() == ".bag") {}

  /// @param times of the points, as a field of float32 of this name; none: no such field
  void cloud(const std::string& topic, const BagTime& time, const std::string& frame,
             const std::vector<Eigen::Vector3f>& points, const std::string& time_field = "",
             const std::vector<float>& times = {}) {
    MessageBytes out(is_ros1_);
    std::vector<std::string> names{"x", "y", "z"};
    if (!times.empty()) names.push_back(time_field);
    const auto count = static_cast<std::uint32_t>(points.size());
    const auto step = static_cast<std::uint32_t>(4 * names.size());
    out.header(time.stamp, frame)
        .add(std::uint32_t{1})
        .add(count)
        .add(static_cast<std::uint32_t>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i)
      out.text(names[i]).add(static_cast<std::uint32_t>(4 * i)).add(std::uint8_t{7}).add(std::uint32_t{1});
    out.add(std::uint8_t{0}).add(step).add(step * count).add(step * count);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) out.add(points[i][axis]);
      if (!times.empty()) out.add(times[i]);
    }
    add("sensor_msgs", "PointCloud2", topic, time, out.add(std::uint8_t{1}));
  }

  /// Livox's CustomMsg. @param times of the points, ns since the stamp
  void livox(const std::string& topic, const BagTime& time, const std::string& frame,
             const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint32_t>& times) {
    MessageBytes out(is_ros1_);
    const auto count = static_cast<std::uint32_t>(points.size());
    out.header(time.stamp, frame).add(static_cast<std::uint64_t>(1e9 * time.stamp)).add(count);
    out.all(std::vector<std::uint8_t>{1, 0, 0, 0}).add(count);
    for (std::size_t i = 0; i < points.size(); ++i)
      out.add(times[i])
          .add(points[i].x())
          .add(points[i].y())
          .add(points[i].z())
          .all(std::vector<std::uint8_t>{200, 16, 3});  // reflectivity, tag, line
    add(is_ros1_ ? "livox_ros_driver" : "livox_ros_driver2", "CustomMsg", topic, time, out);
  }

  void sweep(const std::string& topic, const BagTime& time, const std::string& frame, const BagSweep& sweep,
             const std::vector<float>& ranges) {
    MessageBytes out(is_ros1_);
    const auto steps = static_cast<float>(ranges.size());
    out.header(time.stamp, frame).add(sweep.angle_min);
    out.add(sweep.angle_min + (steps - 1) * sweep.angle_increment).add(sweep.angle_increment);
    out.add(sweep.time_increment).add(steps * sweep.time_increment).add(0.05F).add(sweep.range_max);
    add("sensor_msgs", "LaserScan", topic, time, out.list(ranges).add(std::uint32_t{0}));
  }

  void transform(const BagTime& time, const std::string& parent, const std::string& child,
                 const Eigen::Isometry3d& parent_from_child, bool is_fixed = false) {
    const Eigen::Quaterniond turn(parent_from_child.linear());
    MessageBytes out(is_ros1_);
    out.add(std::uint32_t{1}).header(time.stamp, parent).text(child);
    for (const double value : {parent_from_child.translation().x(), parent_from_child.translation().y(),
                               parent_from_child.translation().z(), turn.x(), turn.y(), turn.z(), turn.w()})
      out.add(value);
    add("tf2_msgs", "TFMessage", is_fixed ? "/tf_static" : "/tf", time, out);
  }

  /// A pose as a message of its own. @param type "nav_msgs/Odometry", "geometry_msgs/PoseStamped", …
  void pose(const std::string& type, const std::string& topic, const BagTime& time, const std::string& parent,
            const std::string& child, const Eigen::Isometry3d& parent_from_child) {
    const Eigen::Quaterniond turn(parent_from_child.linear());
    MessageBytes out(is_ros1_);
    out.header(time.stamp, parent);
    if (!child.empty()) out.text(child);
    for (const double value : {parent_from_child.translation().x(), parent_from_child.translation().y(),
                               parent_from_child.translation().z(), turn.x(), turn.y(), turn.z(), turn.w()})
      out.add(value);
    if (type == "nav_msgs/Odometry") out.all(std::vector<double>(36 + 6 + 36));
    if (type == "geometry_msgs/PoseWithCovarianceStamped") out.all(std::vector<double>(36));
    const auto slash = type.find('/');
    add(type.substr(0, slash), type.substr(slash + 1), topic, time, out);
  }

  /// A nav_msgs/Path of so many poses.
  void path(const std::string& topic, const BagTime& time, const std::string& frame,
            const std::vector<std::pair<double, Eigen::Isometry3d>>& poses) {
    MessageBytes out(is_ros1_);
    out.header(time.stamp, frame);
    out.add(static_cast<std::uint32_t>(poses.size()));
    for (const auto& [stamp, pose] : poses) {
      const Eigen::Quaterniond turn(pose.linear());
      out.header(stamp, "");
      for (const double value : {pose.translation().x(), pose.translation().y(), pose.translation().z(),
                                 turn.x(), turn.y(), turn.z(), turn.w()})
        out.add(value);
    }
    add("nav_msgs", "Path", topic, time, out);
  }

  /// Takes so many bytes from the end of the last message.
  void cut_last(std::size_t bytes) {
    std::string& last = records_.back().bytes;
    last.erase(last.size() - std::min(bytes, last.size()));
  }

  /// Puts the messages so far in the order in which a recorder meets them.
  void sort() {
    std::stable_sort(records_.begin(), records_.end(),
                     [](const BagRecord& a, const BagRecord& b) { return a.time < b.time; });
  }
  void shuffle(unsigned seed) { std::shuffle(records_.begin(), records_.end(), std::mt19937(seed)); }
  void write() const { write_bag(file_, records_, is_ros1_); }

 private:
  void add(const std::string& package, const std::string& type, const std::string& topic, const BagTime& time,
           const MessageBytes& message) {
    records_.push_back({topic, package + (is_ros1_ ? "/" : "/msg/") + type, time.recorded, message.bytes()});
  }

  std::filesystem::path file_;
  bool is_ros1_;
  std::vector<BagRecord> records_;
};

}  // namespace clearway::worlds
