// What BagFrames reads of a bag before it visits what sensors saw.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "datasets/ros/bag_clocks.hpp"
#include "datasets/ros/bag_frames.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/depth_units.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The header of a sensor's message; a damaged one has that time and nothing else.
RosHeader header_of(const BagTopic& topic, const BagMessage& message) {
  try {
    WireReader in(message.bytes, *topic.wire);
    return read_header(in);
  } catch (const std::runtime_error&) {
    return {message.time, ""};
  }
}

/// Its header names a frame of the world: what is in it was moved there.
bool is_odometry(const BagTopic& topic) { return topic.wire && topic.type == "nav_msgs/Odometry"; }

}  // namespace

BagFrames::BagFrames(MessageBag& bag, const SourceOptions& options)
    : bag_(bag), options_(options), depth_step_(options.depth.scale) {
  learn();
  const auto require = [&](const std::string& topic, std::optional<RosCamera>& camera,
                           const std::optional<CameraIntrinsics>& of_setup, bool is_rectified) {
    if (!camera && !topic.empty())
      throw ContradictoryBag("has in topic " + quote(topic) + " no camera that can be used" +
                             account_.reason(topic));
    if (camera || !of_setup) return;
    camera = RosCamera{*of_setup};
    camera->intrinsics.is_rectified = is_rectified;
  };
  require(options.bag.camera_info, camera_, options.camera, are_images_rectified(options.bag));
  require(options.bag.depth_camera_info, depth_camera_,
          options.depth.camera ? options.depth.camera : options.camera, is_depth_rectified(options.bag));
  if (!options.bag.depth.empty()) depth_rays_ = depth_rays(depth_camera_.value().intrinsics);
}

void BagFrames::learn_camera(const std::string& topic, const RosCameraInfo& info) {
  const BagTopics& bag = options_.bag;
  const auto camera_of = [&](bool is_rectified) {
    return is_rectified ? rectified_camera(info) : raw_camera(info);
  };
  if (topic == bag.camera_info && !camera_) camera_ = camera_of(are_images_rectified(bag));
  if (topic == bag.depth_camera_info && !depth_camera_) depth_camera_ = camera_of(is_depth_rectified(bag));
}

void BagFrames::learn_step(const std::string& topic, double step) {
  if (depth_step_) return;  // the setup's, or the first
  depth_step_ = step;
  depth_units_ = topic;
}

std::vector<RosTransform> BagFrames::transforms_in(const BagMessage& message) const {
  const BagTopic& topic = bag_.topics()[message.topic];
  WireReader in(message.bytes, *topic.wire);
  std::vector<RosTransform> transforms;
  if (is_pose(topic)) {
    RosTransform pose = read_pose(in, topic.type);
    if (pose.child.empty()) pose.child = options_.bag.pose_frame;
    if (pose.child.empty() || pose.header.frame.empty())
      throw std::runtime_error("its pose does not say what it is of and in which frame");
    pose.header.time = time_of(pose.header, message.time);
    transforms.push_back(std::move(pose));
  } else {
    transforms = read_transforms(in);
  }
  std::erase_if(transforms, [&](const RosTransform& transform) {
    const auto is_its = [&](const StatedFrame& frame) { return frame.child == transform.child; };
    return std::any_of(options_.bag.frames.begin(), options_.bag.frames.end(), is_its);
  });
  return transforms;
}

std::vector<RosTransform> BagFrames::path_in(const BagMessage& message) const {
  WireReader in(message.bytes, *bag_.topics()[message.topic].wire);
  std::vector<RosTransform> poses = read_path(in);
  for (RosTransform& pose : poses) pose.child = options_.bag.pose_frame;
  const auto is_same_time = [&](const RosTransform& pose) {
    return pose.header.time == poses.front().header.time;
  };
  if (poses.size() > 1 && std::all_of(poses.begin(), poses.end(), is_same_time))
    throw std::runtime_error("the poses of its path have no times of their own");
  return poses;
}

void BagFrames::learn() {
  for (const StatedFrame& frame : options_.bag.frames)
    transforms_.add({{0.0, frame.parent},
                     frame.child,
                     frame.parent_from_child.translation(),
                     Eigen::Quaterniond(frame.parent_from_child.linear())},
                    true, 0.0);
  const bool are_frames_read = !options_.bag.fixed_frame.empty() || takes_sensors_to_stand();
  for (const BagTopic& topic : bag_.topics()) {
    const bool is_camera =
        topic.name == options_.bag.camera_info || topic.name == options_.bag.depth_camera_info;
    sensors_.push_back(topic.wire && is_sensor(topic));
    const bool tells_step = !depth_step_ && is_depth_units(topic, options_.bag.depth);
    read_.push_back(topic.wire && (sensors_.back() || is_camera || tells_step ||
                                   (is_transforms(topic) && are_frames_read) || is_pose(topic)));
  }
  BagClocks clocks;
  std::vector<bool> learned = read_;
  for (std::size_t i = 0; i < learned.size(); ++i) learned[i] = learned[i] || is_odometry(bag_.topics()[i]);
  bag_.visit(learned, [&](const BagMessage& message) {
    const BagTopic& topic = bag_.topics()[message.topic];
    if (const std::string frame = is_odometry(topic) ? header_of(topic, message).frame : ""; !frame.empty())
      odometry_frames_.insert(frame);
    if (!read_[message.topic]) return true;
    if (sensors_[message.topic]) {
      RosHeader header = header_of(topic, message);
      account_.note_stamp(topic.name, header.time);
      header.time = time_of(header, message.time);
      stamps_.push_back(header.time);
      delays_.push_back(message.time - header.time);
      sensor_frames_.insert(header.frame);
      clocks.note(quote(topic.name), header.time, message);
      return true;
    }
    try {
      if (!is_transforms(topic) && !is_pose(topic)) {
        WireReader in(message.bytes, *topic.wire);
        if (is_depth_units(topic, options_.bag.depth))
          learn_step(topic.name, read_depth_units(in));
        else
          learn_camera(topic.name, read_camera_info(in));
        return true;
      }
      if (is_pose(topic) && topic.type == "nav_msgs/Path") {
        paths_[topic.name] = {path_in(message), message.time};
        return true;
      }
      for (const RosTransform& transform : transforms_in(message)) {
        if (message.is_beyond) {
          beyond_.emplace_back(transform, message.time);
          continue;
        }
        transforms_.add(transform, is_fixed(topic), message.time);
        if (!is_fixed(topic) && std::isfinite(transform.header.time))
          clocks.note(quote(topic.name) + ", frame " + quote(transform.child) + ",", transform.header.time,
                      message);
      }
    } catch (const std::runtime_error& error) {
      account_.leave_out(topic.name, error);
    }
    return true;
  });
  clocks.refuse_restarts(bag_.first_time().value_or(0.0));
  add_beyond();
  for (const auto& [topic, path] : paths_)
    for (const RosTransform& pose : path.first) transforms_.add(pose, false, path.second);
  if (options_.bag.fixed_frame.empty()) return;
  if (!options_.bag.sensor_frame.empty()) sensor_frames_.insert(options_.bag.sensor_frame);
  transforms_.prefer_ways_to(options_.bag.fixed_frame);
  refuse_contradictions(transforms_, options_.bag.fixed_frame, sensor_frames_);
}

void BagFrames::add_beyond() {
  if (stamps_.empty() || beyond_.empty()) return;
  const auto [first, last] = std::minmax_element(stamps_.begin(), stamps_.end());
  const auto [least, most] = std::minmax_element(delays_.begin(), delays_.end());
  constexpr double reach = TransformTree::max_gap, most_apart = 1.0;  // s
  for (const auto& [transform, recorded] : beyond_) {
    const double stamp = transform.header.time, delay = recorded - stamp;
    if (stamp >= *first - reach && stamp <= *last + reach && delay >= *least - most_apart &&
        delay <= *most + most_apart)
      transforms_.add(transform, false, recorded);
  }
}

}  // namespace clearway
