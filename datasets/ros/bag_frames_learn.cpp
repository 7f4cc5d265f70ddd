// What BagFrames reads of a bag before it visits what sensors saw.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "datasets/ros/bag_frames.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/cut_bag.hpp"
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

BagFrames::BagFrames(MessageBag& bag, const SourceOptions& options) : bag_(bag), options_(options) {
  for (const DepthTopic& topic : options.bag.depth) depth_[topic.name].step = options.depth.scale;
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
  for (const DepthTopic& topic : options.bag.depth) {
    DepthSensor& sensor = depth_.at(topic.name);
    require(topic.camera_info, sensor.camera, options.depth.camera ? options.depth.camera : options.camera,
            is_depth_rectified(options.bag, topic));
    sensor.rays = depth_rays(sensor.camera.value().intrinsics);
  }
}

void BagFrames::learn_camera(const std::string& topic, const RosCameraInfo& info) {
  const BagTopics& bag = options_.bag;
  const auto camera_of = [&](bool is_rectified) {
    return is_rectified ? rectified_camera(info) : raw_camera(info);
  };
  if (topic == bag.camera_info && !camera_) camera_ = camera_of(are_images_rectified(bag));
  for (const DepthTopic& depth : bag.depth)
    if (auto& camera = depth_.at(depth.name).camera; topic == depth.camera_info && !camera)
      camera = camera_of(is_depth_rectified(bag, depth));
}

void BagFrames::learn_step(const BagTopic& topic, double step) {
  for (auto& [name, sensor] : depth_) {
    if (sensor.step || !is_depth_units(topic, name)) continue;  // the setup's, or the first
    sensor.step = step;
    sensor.units = topic.name;
  }
}

bool BagFrames::is_camera(const BagTopic& topic) const {
  const auto& depth = options_.bag.depth;
  return topic.name == options_.bag.camera_info ||
         std::any_of(depth.begin(), depth.end(),
                     [&](const DepthTopic& one) { return one.camera_info == topic.name; });
}

bool BagFrames::tells_step(const BagTopic& topic) const {
  return std::any_of(depth_.begin(), depth_.end(), [&](const auto& sensor) {
    return !sensor.second.step && is_depth_units(topic, sensor.first);
  });
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
    pose.header.time = time_in(topic.name, pose.header, message.time);
    transforms.push_back(std::move(pose));
  } else {
    transforms = read_transforms(in);
    for (RosTransform& transform : transforms)
      transform.header.time = options_.bag.time_of(topic.name, transform.header.time, message.time);
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
    sensors_.push_back(topic.wire && is_sensor(topic));
    read_.push_back(topic.wire && (sensors_.back() || is_camera(topic) || tells_step(topic) ||
                                   (is_transforms(topic) && are_frames_read) || is_pose(topic)));
  }
  BagClocks clocks;
  std::map<std::string, std::string> poses;  // streams of them, and their frames
  std::vector<bool> learned = read_;
  const auto has_joints = [&](const BagTopic& topic) {
    return topic.wire && topic.type == "sensor_msgs/JointState" && topic.name == options_.bag.joint_topic;
  };
  for (std::size_t i = 0; i < learned.size(); ++i)
    learned[i] = learned[i] || is_odometry(bag_.topics()[i]) || has_joints(bag_.topics()[i]);
  bag_.visit(learned, [&](const BagMessage& message) {
    const BagTopic& topic = bag_.topics()[message.topic];
    if (const std::string frame = is_odometry(topic) ? header_of(topic, message).frame : ""; !frame.empty())
      odometry_frames_.insert(frame);
    if (has_joints(topic))
      clocks.note(quote(topic.name), time_in(topic.name, header_of(topic, message), message.time), message);
    if (!read_[message.topic]) return true;
    if (sensors_[message.topic]) {
      RosHeader header = header_of(topic, message);
      if (options_.bag.times != BagTimes::recording) account_.note_stamp(topic.name, header.time);
      header.time = time_in(topic.name, header, message.time);
      stamps_.push_back(header.time);
      delays_.push_back(message.time - header.time);
      sensor_frames_.insert(header.frame);
      clocks.note(quote(topic.name), header.time, message);
      return true;
    }
    try {
      if (!is_transforms(topic) && !is_pose(topic)) {
        WireReader in(message.bytes, *topic.wire);
        if (is_camera(topic))
          learn_camera(topic.name, read_camera_info(in));
        else
          learn_step(topic, read_depth_units(in));
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
        if (is_fixed(topic) || !std::isfinite(transform.header.time)) continue;
        const std::string stream = quote(topic.name) + ", frame " + quote(transform.child) + ",";
        clocks.note(stream, transform.header.time, message);
        poses[stream] = transform.child;
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
  if (!options_.bag.fixed_frame.empty()) transforms_.prefer_ways_to(options_.bag.fixed_frame);
  refuse_clocks(clocks, poses);
  if (options_.bag.fixed_frame.empty()) return;
  if (!options_.bag.sensor_frame.empty()) sensor_frames_.insert(options_.bag.sensor_frame);
  refuse_contradictions(transforms_, options_.bag.fixed_frame, sensor_frames_);
}

void BagFrames::refuse_clocks(const BagClocks& clocks, const std::map<std::string, std::string>& poses) {
  std::vector<std::string> sensors, used;
  for (const std::string& name : clocks.names())
    if (!poses.contains(name)) sensors.push_back(name);
  if (!options_.bag.fixed_frame.empty()) {
    const std::set<std::string> frames = used_frames(transforms_, options_.bag.fixed_frame, sensor_frames_);
    for (const auto& [name, frame] : poses)
      if (frames.contains(frame)) used.push_back(name);
  }
  std::vector<std::string> all = sensors;
  all.insert(all.end(), used.begin(), used.end());
  if (options_.bag.times != BagTimes::stamps) clocks.refuse_set_back(all, bag_.first_time().value_or(0.0));
  if (options_.bag.times != BagTimes::agreeing_stamps) return;
  clock_notes_ = clocks.refuse_offsets(sensors);
  for (std::string& note : clocks.refuse_pose_offsets(sensors, used)) clock_notes_.push_back(std::move(note));
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
