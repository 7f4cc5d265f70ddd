#include "datasets/ros/bag_frames.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "datasets/ros/bag_clocks.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/compressed_depth.hpp"
#include "datasets/ros/cut_bag.hpp"
#include "datasets/ros/depth_units.hpp"
#include "datasets/ros/sensor_frames.hpp"
#include "datasets/ros/sensor_sweep.hpp"
#include "datasets/ros/stamp_order.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Seconds to the millisecond.
std::string time_text(double time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << time;
  return text.str();
}

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

/// Frames of the world that something drives in: REP 105's, and that of programs that register clouds (LOAM
/// and its heirs).
bool is_start_name(const std::string& frame) { return frame == "odom" || frame == "camera_init"; }
bool is_world_name(const std::string& frame) {
  return frame == "map" || frame == "world" || frame == "earth";
}

constexpr std::size_t most_held_bytes = std::size_t{64} << 20U;  ///< of messages that wait for their turn

/// "… jumps by 0.9 m in ": a frame may also turn at once, or stand still where it drives before and after.
std::string how_it_jumps(const PoseJump& jump) {
  constexpr double little = 0.05;  // m, rad
  if (jump.distance >= little) return " jumps by " + short_text(jump.distance) + " m in ";
  if (jump.turn >= little) return " turns at once by " + short_text(jump.turn) + " rad in ";
  return " stands still, against its speed before and after, in ";
}

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

bool BagFrames::is_sensor(const BagTopic& topic) const {
  const BagTopics& bag = options_.bag;
  return topic.name == bag.images || topic.name == bag.depth || holds(bag.clouds, topic.name) ||
         holds(bag.scans, topic.name);
}

bool BagFrames::is_pose(const BagTopic& topic) const { return holds(options_.bag.poses, topic.name); }

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

void BagFrames::visit(const std::function<void(const Frame&)>& take) {
  visit_by_stamp(bag_, read_, sensors_, stamps_, most_held_bytes, [&](const BagMessage& message) {
    try {
      for (const Frame& frame : frames_in(message)) take(frame);
    } catch (const std::runtime_error& error) {
      account_.leave_out(bag_.topics()[message.topic].name, error);
    }
  });
}

/// A scan whose readings from `no_return` on are beyond its range.
RosLaserScan BagFrames::laser_scan_in(WireReader& in) const {
  RosLaserScan scan = read_laser_scan(in);
  const auto least = static_cast<float>(options_.no_return);
  if (least > 0.0F && scan.range_max > least) scan.range_max = least;
  return scan;
}

std::vector<Frame> BagFrames::frames_in(const BagMessage& message) {
  const BagTopic& topic = bag_.topics()[message.topic];
  if (topic.type == "sensor_msgs/LaserScan") {
    WireReader in(message.bytes, *topic.wire);
    const RosLaserScan scan = laser_scan_in(in);
    if (has_opposite_angles(scan)) account_.note_opposite_angles(topic.name);
    if (scan.time_increment != 0.0F && !options_.bag.fixed_frame.empty())
      return frames_of_sweep(scan, topic.name, time_of(scan.header, message.time), 0.25 * options_.resolution,
                             options_.clear_infinite,
                             [&](double time) { return pose_of(scan.header.frame, time, message.time); });
  }
  if (topic.type == "sensor_msgs/PointCloud2" || is_livox_cloud(topic.type)) return frames_of_cloud(message);
  return {frame_of(message)};
}

Eigen::Isometry3d BagFrames::pose_of(const std::string& frame, double time, double recorded) const {
  const auto pose = transforms_.root_from_frame(options_.bag.fixed_frame, frame, time, recorded);
  if (const auto jump = pose ? std::nullopt : transforms_.jump_between(options_.bag.fixed_frame, frame, time))
    throw JumpedPose("frame " + quote(jump->frame) + how_it_jumps(*jump) + quote(jump->parent) + " between " +
                     time_text(jump->before) + " and " + time_text(jump->after) + " s");
  if (!pose)
    throw std::runtime_error("frame " + quote(frame) + " is not known in " + quote(options_.bag.fixed_frame) +
                             why_unknown(frame));
  return *pose;
}

std::vector<Frame> BagFrames::frames_of_cloud(const BagMessage& message) {
  const BagTopic& topic = bag_.topics()[message.topic];
  WireReader in(message.bytes, *topic.wire);
  RosPointCloud cloud = is_livox_cloud(topic.type) ? read_livox_cloud(in) : read_point_cloud(in);
  if (has_other_order(cloud)) {
    cloud.is_bigendian = !cloud.is_bigendian;
    account_.note_other_order(topic.name);
  }
  Frame frame{time_of(cloud.header, message.time), topic.name, points_cloud(cloud)};
  auto& points = std::get<CloudFrame>(frame.content);
  if (options_.bag.fixed_frame.empty()) {
    note_origin(points, topic.name, cloud.header.frame);
    return {frame};
  }
  points.world_from_sensor = pose_of(cloud.header.frame, frame.time, message.time);
  const bool is_own = options_.bag.sensor_frame.empty() || options_.bag.sensor_frame == cloud.header.frame;
  place(points, topic.name, {frame.time, cloud.header.frame}, points.world_from_sensor, message.time);
  if (is_own && points.is_origin_known && !is_placed(topic.name, "points")) {
    std::vector<Frame> parts = parts_in_time(cloud, frame, message.time);
    if (!parts.empty()) return parts;
  }
  return {frame};
}

std::vector<Frame> BagFrames::parts_in_time(const RosPointCloud& cloud, const Frame& frame, double recorded) {
  auto seen = point_times(cloud);
  if (!seen) return {};
  if (seen->times.empty()) {
    account_.note_odd_times(frame.sensor, quote(seen->field) + " spans " + short_text(seen->raw_span));
    return {};
  }
  for (double& time : seen->times) time += frame.time;
  const auto [first, last] = std::minmax_element(seen->times.begin(), seen->times.end());
  const auto pose_at = [&](double time) { return pose_of(cloud.header.frame, time, recorded); };
  const auto& points = std::get<CloudFrame>(frame.content);
  const Eigen::Isometry3d last_from_first = pose_at(*last).inverse() * pose_at(*first);
  double farthest = 0.0;
  for (const Eigen::Vector3f& point : points.points) {
    const Eigen::Vector3d place = point.cast<double>();
    farthest = std::max(farthest, (last_from_first * place - place).norm());
  }
  if (farthest > options_.resolution) account_.note_motion(frame.sensor, seen->field, farthest);
  if (!options_.bag.point_times || farthest <= 0.25 * options_.resolution) return {};
  return frames_of_timed_cloud(points, seen->times, frame.sensor, 0.25 * options_.resolution, pose_at);
}

Frame BagFrames::frame_of(const BagMessage& message) {
  const BagTopics& bag = options_.bag;
  const BagTopic& topic = bag_.topics()[message.topic];
  WireReader in(message.bytes, *topic.wire);
  Frame frame;
  frame.sensor = topic.name;
  RosHeader header;
  Eigen::Isometry3d message_from_sensor = Eigen::Isometry3d::Identity();
  if (topic.name == bag.depth) {
    UnpackedDepth unpacked;
    if (topic.type == "sensor_msgs/CompressedImage")
      unpacked = unpack_depth(read_compressed_image(in));
    else
      unpacked.image = read_image(in);
    header = unpacked.image.header;
    CloudFrame cloud =
        depth_cloud(unpacked.image, depth_camera_->intrinsics, depth_rays_, depth_step_.value_or(1e-3));
    cloud.max_range = options_.depth.max_range;
    message_from_sensor = optical_from_sensor();
    message_from_sensor.prerotate(depth_camera_->frame_from_camera);
    frame.content = std::move(cloud);
  } else if (topic.name == bag.images) {
    ImageFrame picture;
    if (topic.type == "sensor_msgs/CompressedImage") {
      const RosCompressedImage image = read_compressed_image(in);
      header = image.header;
      picture.image = gray_image(image);
    } else {
      const RosImage image = read_image(in);
      header = image.header;
      picture.image = gray_image(image);
    }
    picture.intrinsics = camera_->intrinsics;
    message_from_sensor.linear() = camera_->frame_from_camera;
    frame.content = std::move(picture);
  } else {
    const RosLaserScan scan = laser_scan_in(in);
    header = scan.header;
    frame.content = laser_cloud(scan, options_.clear_infinite);
  }
  frame.time = time_of(header, message.time);
  if (bag.fixed_frame.empty()) return frame;
  const Eigen::Isometry3d world_from_sensor =
      pose_of(header.frame, frame.time, message.time) * message_from_sensor;
  if (auto* picture = std::get_if<ImageFrame>(&frame.content)) picture->world_from_sensor = world_from_sensor;
  if (auto* cloud = std::get_if<CloudFrame>(&frame.content)) cloud->world_from_sensor = world_from_sensor;
  return frame;
}

void BagFrames::place(CloudFrame& cloud, const std::string& topic, const RosHeader& header,
                      Eigen::Isometry3d world_from_cloud, double recorded) {
  const BagTopics& bag = options_.bag;
  if (bag.sensor_frame == header.frame) return;
  if (!bag.sensor_frame.empty()) {
    cloud.world_from_sensor = pose_of(bag.sensor_frame, header.time, recorded);
    const Eigen::Isometry3d sensor_from_cloud = cloud.world_from_sensor.inverse() * world_from_cloud;
    for (Eigen::Vector3f& point : cloud.points)
      point = (sensor_from_cloud * point.cast<double>()).cast<float>();
    return;
  }
  note_origin(cloud, topic, header.frame);
}

void BagFrames::note_origin(CloudFrame& cloud, const std::string& topic, const std::string& frame) {
  if (options_.bag.sensor_frame == frame && !frame.empty()) return;
  const auto [known, is_new] = no_sensors_.try_emplace(frame, false);
  if (is_new) known->second = is_no_sensors(frame);
  cloud.is_origin_known = !known->second || is_placed(topic, "points");
  if (!cloud.is_origin_known)
    account_.note_unseen(topic, frame);
  else if (is_world_name(frame) && !is_placed(topic, "points"))
    account_.note_standing(topic, frame);
}

bool BagFrames::is_no_sensors(const std::string& frame) const {
  const bool are_poses_there = !transforms_.frames().empty() || !odometry_frames_.empty();
  return is_start_name(frame) || (is_world_name(frame) && are_poses_there) ||
         odometry_frames_.contains(frame) ||
         (!options_.bag.fixed_frame.empty() && is_driven_in(transforms_, options_.bag.fixed_frame, frame));
}

bool BagFrames::is_placed(const std::string& topic, const char* kind) const {
  return holds(options_.placed, topic) || holds(options_.placed, kind);
}

bool BagFrames::takes_sensors_to_stand() const {
  const BagTopics& bag = options_.bag;
  if (!bag.fixed_frame.empty()) return false;
  return (!bag.depth.empty() && !is_placed(bag.depth, "depth")) ||
         !std::all_of(bag.clouds.begin(), bag.clouds.end(),
                      [&](const std::string& topic) { return is_placed(topic, "points"); }) ||
         !std::all_of(bag.scans.begin(), bag.scans.end(),
                      [&](const std::string& topic) { return is_placed(topic, "laser2d"); });
}

std::string BagFrames::why_unknown(const std::string& frame) const {
  const std::vector<std::string> frames = transforms_.frames();
  for (const std::string& name : {options_.bag.fixed_frame, frame})
    if (!holds(frames, name))
      return ": no transform has " + quote(name) + "; frames of the bag: " + list_of_frames(frames);
  return " at its time";
}

std::vector<std::string> BagFrames::left_out() const {
  std::vector<std::string> clauses = account_.clauses(transforms_.frames(), options_.bag.point_times);
  if (!depth_units_.empty())
    clauses.push_back("has depth in steps of " + short_text(depth_step_.value()) + " m, by its topic " +
                      quote(depth_units_) + "; `source: {depth: {scale: …}}` states others");
  if (options_.bag.fixed_frame.empty() && !transforms_.frames().empty())
    clauses.push_back(
        "has transforms, but its sensors are taken to stand still: the setup names no "
        "'source: bag: fixed_frame'; frames of the bag: " +
        list_of_frames(transforms_.frames()));
  if (!options_.bag.fixed_frame.empty())
    for (const std::string& clause :
         tell_contradictions(transforms_, options_.bag.fixed_frame, sensor_frames_))
      clauses.push_back(clause);
  if (transforms_.left_out() > 0)
    clauses.push_back("holds " + std::to_string(transforms_.left_out()) +
                      " transforms that are no turns, not finite, or of a frame in itself");
  return clauses;
}

}  // namespace clearway
