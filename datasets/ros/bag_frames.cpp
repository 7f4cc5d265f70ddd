#include "datasets/ros/bag_frames.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "datasets/cameras/rigid_pose.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/compressed_depth.hpp"
#include "datasets/ros/cut_bag.hpp"
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

constexpr std::size_t most_held_bytes = std::size_t{64} << 20U;  ///< of messages that wait for their turn

/// "… jumps by 0.9 m in ": a frame may also turn at once, or stand still where it drives before and after.
std::string how_it_jumps(const PoseJump& jump) {
  constexpr double little = 0.05;  // m, rad
  if (jump.distance >= little) return " jumps by " + short_text(jump.distance) + " m in ";
  if (jump.turn >= little) return " turns at once by " + short_text(jump.turn) + " rad in ";
  return " stands still, against its speed before and after, in ";
}

}  // namespace

bool BagFrames::is_sensor(const BagTopic& topic) const {
  const BagTopics& bag = options_.bag;
  return topic.name == bag.images || depth_.contains(topic.name) || holds(bag.clouds, topic.name) ||
         holds(bag.scans, topic.name);
}

bool BagFrames::is_pose(const BagTopic& topic) const { return holds(options_.bag.poses, topic.name); }

void BagFrames::visit(const std::function<void(const Frame&)>& take) {
  visit_by_stamp(bag_, read_, sensors_, stamps_, most_held_bytes, [&](const BagMessage& message) {
    try {
      for (const Frame& frame : frames_in(message)) take(frame);
    } catch (const std::runtime_error& error) {
      account_.leave_out(bag_.topics()[message.topic].name, error);
    }
  });
}

double BagFrames::time_in(const std::string& topic, const RosHeader& header, double recorded) const {
  return options_.bag.time_of(topic, time_of(header, recorded), recorded);
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
    RosLaserScan scan = laser_scan_in(in);
    scan.header.time = time_in(topic.name, scan.header, message.time);
    if (has_opposite_angles(scan)) account_.note_opposite_angles(topic.name);
    const bool is_merged = this->is_merged(scan, topic.name, message.time);
    if (scan.time_increment != 0.0F && !options_.bag.fixed_frame.empty() && !is_merged)
      return frames_of_sweep(scan, topic.name, scan.header.time, 0.25 * options_.resolution,
                             options_.clear_infinite,
                             [&](double time) { return pose_of(scan.header.frame, time, message.time); });
    Frame frame = frame_of(message);
    if (is_merged)
      place_merged(std::get<CloudFrame>(frame.content), topic.name, {frame.time, scan.header.frame},
                   message.time);
    return {frame};
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
                             why_unknown(frame, time));
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
  Frame frame{time_in(topic.name, cloud.header, message.time), topic.name, points_cloud(cloud)};
  auto& points = std::get<CloudFrame>(frame.content);
  const bool keeps_times = options_.bag.point_times && !options_.bag.robot_base.empty();
  std::optional<PointTimes> seen;
  if (keeps_times || !options_.bag.fixed_frame.empty()) seen = point_times(cloud);
  if (seen && keeps_times) points.times.assign(seen->times.begin(), seen->times.end());
  if (options_.bag.fixed_frame.empty()) {
    note_origin(points, topic.name, {frame.time, cloud.header.frame}, message.time);
    return {frame};
  }
  points.world_from_sensor = pose_of(cloud.header.frame, frame.time, message.time);
  const bool is_own = options_.bag.sensor_frame.empty() || options_.bag.sensor_frame == cloud.header.frame;
  place(points, topic.name, {frame.time, cloud.header.frame}, points.world_from_sensor, message.time);
  if (seen && is_own && points.is_origin_known && !is_placed(topic.name, "points")) {
    std::vector<Frame> parts = parts_in_time(*seen, cloud.header.frame, frame, message.time);
    if (!parts.empty()) return parts;
  }
  return {frame};
}

std::vector<Frame> BagFrames::parts_in_time(PointTimes seen, const std::string& tf_frame, const Frame& frame,
                                            double recorded) {
  if (seen.times.empty()) {
    account_.note_odd_times(frame.sensor, quote(seen.field) + " spans " + short_text(seen.raw_span));
    return {};
  }
  for (double& time : seen.times) time += frame.time;
  const auto [first, last] = std::minmax_element(seen.times.begin(), seen.times.end());
  const auto pose_at = [&](double time) { return pose_of(tf_frame, time, recorded); };
  const auto& points = std::get<CloudFrame>(frame.content);
  const Eigen::Isometry3d last_from_first = pose_at(*last).inverse() * pose_at(*first);
  double farthest = 0.0;
  for (const Eigen::Vector3f& point : points.points) {
    const Eigen::Vector3d place = point.cast<double>();
    farthest = std::max(farthest, (last_from_first * place - place).norm());
  }
  if (farthest > options_.resolution) account_.note_motion(frame.sensor, seen.field, farthest);
  if (!options_.bag.point_times || farthest <= 0.25 * options_.resolution) return {};
  return frames_of_timed_cloud(points, seen.times, frame.sensor, 0.25 * options_.resolution, pose_at);
}

Frame BagFrames::frame_of(const BagMessage& message) {
  const BagTopics& bag = options_.bag;
  const BagTopic& topic = bag_.topics()[message.topic];
  WireReader in(message.bytes, *topic.wire);
  Frame frame;
  frame.sensor = topic.name;
  RosHeader header;
  Eigen::Isometry3d message_from_sensor = Eigen::Isometry3d::Identity();
  if (const auto depth = depth_.find(topic.name); depth != depth_.end()) {
    const DepthSensor& sensor = depth->second;
    UnpackedDepth unpacked;
    if (topic.type == "sensor_msgs/CompressedImage")
      unpacked = unpack_depth(read_compressed_image(in));
    else
      unpacked.image = read_image(in);
    header = unpacked.image.header;
    CloudFrame cloud =
        depth_cloud(unpacked.image, sensor.camera->intrinsics, sensor.rays, sensor.step.value_or(1e-3));
    cloud.max_range = options_.depth.max_range;
    message_from_sensor = optical_from_sensor();
    message_from_sensor.prerotate(sensor.camera->frame_from_camera);
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
  frame.time = time_in(topic.name, header, message.time);
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
  note_origin(cloud, topic, header, recorded);
}

void BagFrames::note_origin(CloudFrame& cloud, const std::string& topic, const RosHeader& header,
                            double recorded) {
  const std::string& frame = header.frame;
  if ((options_.bag.sensor_frame == frame && !frame.empty()) || is_placed(topic, "points")) return;
  const auto [known, is_new] = no_sensors_.try_emplace(frame, false);
  if (is_new) known->second = is_no_sensors(frame);
  cloud.is_origin_known = !known->second;
  if (known->second)
    account_.note_unseen(topic, frame);
  else if (is_world_name(frame))
    account_.note_standing(topic, frame);
  else
    cloud.is_origin_known = !is_bodys(topic, header, recorded);
}

const MountedFrames& BagFrames::mounted_at(const RosHeader& header, double recorded) {
  const auto [known, is_new] = mounted_.try_emplace(header.frame);
  if (is_new || known->second.names.empty())  // where nothing hangs on it, a transform may come later
    known->second = mounted_on(transforms_, header.frame, time_of(header, recorded), recorded);
  return known->second;
}

bool BagFrames::is_merged(const RosLaserScan& scan, const std::string& topic, double recorded) {
  constexpr double nearly_all = 6.1;  // rad
  const double circle = static_cast<double>(scan.ranges.size()) * std::abs(double{scan.angle_increment});
  return circle >= nearly_all && is_body_name(scan.header.frame) && !is_placed(topic, "laser2d") &&
         !mounted_at(scan.header, recorded).names.empty();
}

void BagFrames::place_merged(CloudFrame& cloud, const std::string& topic, const RosHeader& header,
                             double recorded) {
  const std::string& sensor = options_.bag.sensor_frame;
  if (sensor == header.frame) return;
  cloud.clear_to.clear();  // what no laser saw is there, too
  if (sensor.empty() || options_.bag.fixed_frame.empty())
    cloud.is_origin_known = !is_bodys(topic, header, recorded);
  else
    place(cloud, topic, header, cloud.world_from_sensor, recorded);
}

bool BagFrames::is_bodys(const std::string& topic, const RosHeader& header, double recorded) {
  const MountedFrames& mounted = mounted_at(header, recorded);
  const bool is_body = is_body_name(header.frame) && !mounted.names.empty();
  if (is_body || (mounted.are_sensors && !is_sensor_name(header.frame)))
    account_.note_mounted(topic, header.frame, mounted, is_body);
  return is_body;
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
  return !std::all_of(bag.depth.begin(), bag.depth.end(), [&](const DepthTopic& topic) {
    return is_placed(topic.name, "depth");
  }) || !std::all_of(bag.clouds.begin(), bag.clouds.end(), [&](const std::string& topic) {
    return is_placed(topic, "points");
  }) || !std::all_of(bag.scans.begin(), bag.scans.end(), [&](const std::string& topic) {
    return is_placed(topic, "laser2d");
  });
}

std::string BagFrames::why_unknown(const std::string& frame, double time) const {
  const std::vector<std::string> frames = transforms_.frames();
  if (frames.empty() && transforms_.left_out() > 0)
    return ": none of the bag's " + std::to_string(transforms_.left_out()) +
           " transforms can be used, as they are no turns (quaternions off unit length by more than 1 %), "
           "not finite, or of a frame in itself";
  for (const std::string& name : {options_.bag.fixed_frame, frame})
    if (!holds(frames, name))
      return ": no transform has " + quote(name) + "; frames of the bag: " + list_of_frames(frames);
  const auto times = transforms_.times_between(options_.bag.fixed_frame, frame);
  if (!times) return ": no chain of transforms joins the two";
  constexpr double years = 1e8;  // s
  std::string why =
      " at its time, " + time_text(time) + " s: transforms of all frames between the two cover ";
  why += times->first <= times->second ? time_text(times->first) + " to " + time_text(times->second) + " s"
                                       : "no time together: some begin at " + time_text(times->first) +
                                             " s, others end at " + time_text(times->second) + " s";
  if (time < years && times->first - time > years)
    why +=
        ", and the message's stamp counts from when its sensor started: expected a driver that stamps by the "
        "clock of ROS";
  if (time > times->first && time < times->second)
    why += ", those of one around it more than " + short_text(TransformTree::max_gap) + " s apart";
  return why;
}

std::vector<std::string> BagFrames::left_out() const {
  std::vector<std::string> clauses = account_.clauses(transforms_.frames(), options_.bag.point_times);
  clauses.insert(clauses.end(), clock_notes_.begin(), clock_notes_.end());
  for (const auto& [topic, sensor] : depth_)
    if (!sensor.units.empty())
      clauses.push_back("has depth in steps of " + short_text(sensor.step.value()) + " m, by its topic " +
                        quote(sensor.units) + "; `source: {depth: {scale: …}}` states others");
  if (options_.bag.fixed_frame.empty() && !transforms_.frames().empty())
    clauses.push_back(
        "has transforms, but its sensors are taken to stand still: the setup names no "
        "'source: bag: fixed_frame'; frames of the bag: " +
        list_of_frames(transforms_.frames()));
  if (!options_.bag.fixed_frame.empty())
    for (const std::string& clause :
         tell_contradictions(transforms_, options_.bag.fixed_frame, sensor_frames_))
      clauses.push_back(clause);
  if (!options_.bag.fixed_frame.empty() && !options_.bag.robot_base.empty())
    if (const std::string moves =
            tell_moving_base(transforms_, options_.bag.fixed_frame, options_.bag.robot_base);
        !moves.empty())
      clauses.push_back(moves);
  if (transforms_.left_out() > 0 && !transforms_.frames().empty())  // else why_unknown says so
    clauses.push_back("holds " + std::to_string(transforms_.left_out()) +
                      " transforms that are no turns, not finite, or of a frame in itself");
  return clauses;
}

}  // namespace clearway
