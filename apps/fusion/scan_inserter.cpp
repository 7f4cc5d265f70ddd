#include "apps/fusion/scan_inserter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/fusion/joint_readings.hpp"
#include "apps/query/query.hpp"
#include "apps/query/setup_robot.hpp"
#include "datasets/poses/tum_poses.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_waiting = 128;  ///< some seconds of a camera's
constexpr double farthest = 300.0;         ///< m, of what is cast without a max_range

/// The robot's bodies at its setup's joints, as the spheres that cover them, grown by the margin.
std::vector<Capsule> robot_capsules(const RobotSetup& setup) {
  const Robot robot = planned_robot(setup);
  if (setup.joints.size() != robot.dof()) {
    throw std::invalid_argument("setup, robot, field 'joints': got " + counted(setup.joints.size(), "value") +
                                ", expected " + std::to_string(robot.dof()) + " (robot '" + robot.name +
                                "')");
  }
  for (std::size_t i = 0; i < setup.joints.size(); ++i)
    require_possible(robot.joints[i], setup.joints[i], "setup, robot, field 'joints'");
  const Configuration q =
      Eigen::Map<const Configuration>(setup.joints.data(), static_cast<Eigen::Index>(setup.joints.size()));
  const LinkPoses poses = forward_kinematics(robot, q);
  std::vector<Capsule> capsules;
  for (const Body& body : robot.bodies) {
    const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(body.link)];
    for (const Sphere& sphere : body.cover) {
      const Eigen::Vector3d center = pose * sphere.center;
      capsules.push_back({center, center, sphere.radius + setup.self_margin});
    }
  }
  return capsules;
}

/// The setup's filter; what is in the way is added scan by scan.
ScanFilter filter_of(const MapSetup& map) {
  ScanFilter filter;
  filter.min_range = map.min_range.value_or(0.0);
  filter.max_range = map.max_range.value_or(0.0);
  filter.thin_to = map.thin_to;
  if (map.outliers) {
    filter.outlier_neighbours = map.outliers->neighbours;
    filter.outlier_deviations = map.outliers->deviations;
  }
  if (map.crop) filter.crop = *map.crop;
  return filter;
}

/// The link that a sensor is on.
int link_of(const SensorSetup& sensor, const Robot& robot) {
  if (sensor.link == "tip") {
    require_one_tip(robot);
    return robot.tip_link;
  }
  std::string names;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].name == sensor.link) return static_cast<int>(i);
    names += ", '" + robot.links[i].name + "'";
  }
  throw std::invalid_argument("setup, sensor '" + sensor.name + "': the robot has no link '" +
                              shortened(sensor.link) + "', expected 'tip'" + shortened(names));
}

/// Points in millimetres would be cast through kilometres of voxels.
void require_metres(const Scan& scan, const MapSetup& map) {
  if (map.max_range) return;
  std::size_t finite = 0, far = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    finite += point.allFinite();
    far += point.allFinite() && point.norm() > farthest;
  }
  if (2 * far > finite)
    throw std::invalid_argument("scan of sensor " + quote(scan.sensor) + ": " + grouped(far) + " of its " +
                                grouped(finite) + " points lie farther away than " + short_text(farthest) +
                                " m, expected metres, or map.max_range in the setup");
}

/// Some lasers, and programs that convert their logs, call what they did not see the largest range, and
/// sound: the clause that says so where many readings are of one range and few are nearly as far; else empty.
std::string range_spike(const std::string& sensor, const ScanInserter::RangeCounts& ranges) {
  constexpr std::size_t least = 100;
  constexpr double least_share = 1e-3;
  if (ranges.empty()) return "";
  const std::size_t largest = ranges.size() - 1, at_largest = ranges.back();
  const auto from = ranges.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(largest));
  const auto all = std::accumulate(ranges.begin(), ranges.end(), std::size_t{0});
  const auto nearly = std::accumulate(from, ranges.end() - 1, std::size_t{0});
  if (at_largest < least || static_cast<double>(at_largest) < least_share * static_cast<double>(all) ||
      nearly > at_largest || all - at_largest < least)  // of the last, a round room may be all that there is
    return "";
  const auto text = [](std::size_t millimetres) {
    return short_text(0.001 * static_cast<double>(millimetres), 6);
  };
  return grouped(at_largest) + " of " + grouped(all) + " readings of laser " + quote(sensor) + " are " +
         text(largest) + " m, its largest, and " + grouped(nearly) +
         " others lie beyond 0.9 of it: some lasers say so where nothing came back; `source: {scans: "
         "{no_return: " +
         text(largest - 1) + "}}` of the setup leaves them out";  // they are rounded
}

}  // namespace

ScanInserter::ScanInserter(const Setup& setup, FreeSpaceMap& map, FusionCounts& counts,
                           const BoardPoses& boards, const MovingRobot* robot, FusionObserver* observer)
    : setup_(setup),
      map_(map),
      counts_(counts),
      boards_(boards),
      held_(setup, boards, map.options().resolution),
      moving_robot_(robot),
      observer_(observer) {
  for (const SensorSetup& sensor : setup.sensors) {
    if (!sensor.poses.empty()) {
      std::size_t left_out = 0;
      streams_.emplace(sensor.name, load_tum_poses(sensor.poses, sensor.max_gap, &left_out));
      if (left_out > 0) counts_.lost_poses.push_back(left_out_poses(sensor.poses, left_out));
      if (const auto fast = too_fast_poses(sensor.poses, streams_.at(sensor.name)))
        counts_.lost_poses.push_back(*fast);
      else if (const auto jumping = jumping_poses(sensor.poses, streams_.at(sensor.name)))
        counts_.lost_poses.push_back(*jumping);
    }
    if (!sensor.link.empty()) links_.emplace(sensor.name, link_of(sensor, robot->robot()));
  }
  if (setup.robot && !setup.robot->joints.empty()) robot_ = robot_capsules(*setup.robot);
}

void ScanInserter::take(const Frame& frame, const CloudFrame& cloud) {
  ++counts_.scans;
  Waiting waiting{{frame.time, frame.sensor, cloud.world_from_sensor, cloud.points},
                  setup_.sensor(frame.sensor, cloud.kind),
                  cloud.unusable,
                  cloud.times};
  waiting.scan.has_hits_only = !cloud.is_origin_known;
  constexpr std::size_t most_named = 20;
  if (waiting.sensor != nullptr) {
    counts_.placed_sensors.insert(waiting.sensor->name);
  } else {
    if (counts_.unplaced_scans.size() < most_named) counts_.unplaced_scans.emplace(frame.sensor, cloud.kind);
    const Eigen::Isometry3d& own = cloud.world_from_sensor;
    counts_.has_poses_of_scans =
        counts_.has_poses_of_scans || !own.isApprox(Eigen::Isometry3d::Identity(), 1e-9);
  }
  counts_.infinite_beams += cloud.infinite;
  counts_.beams_at_range += cloud.at_range;
  if (setup_.source.clear_infinite)
    for (const Eigen::Vector3f& end : cloud.clear_to)
      if (setup_.map.max_range || end.norm() <= farthest) waiting.scan.clear_to.push_back(end);
  if (cloud.kind == "laser2d") {
    take_no_returns(waiting.scan);
    count_ranges(waiting.scan, laser_ranges_[frame.sensor]);
  }
  waiting_.push_back(std::move(waiting));
  release();
}

void ScanInserter::take_no_returns(Scan& scan) {
  const double least = setup_.source.no_return;
  if (least == 0.0 || !setup_.source.bag.scans.empty())
    return;  // those of bags are read so, before they sweep
  const std::size_t taken = std::erase_if(scan.points, [&](const Eigen::Vector3f& point) {
    const double range = point.cast<double>().norm();
    if (!(range >= least - 1e-6 * least)) return false;  // as floats have it
    if (setup_.source.clear_infinite && (setup_.map.max_range || least <= farthest))
      scan.clear_to.emplace_back(point * static_cast<float>(least / range));
    return true;
  });
  counts_.infinite_beams += taken;
  counts_.beams_at_range += taken;
}

void ScanInserter::count_ranges(const Scan& scan, RangeCounts& counts) const {
  const double most = std::min(setup_.map.max_range.value_or(farthest), farthest);
  for (const Eigen::Vector3f& point : scan.points) {
    const double range = point.norm();
    if (!(range < most)) continue;
    const auto place = static_cast<std::size_t>(std::lround(1000.0 * range));
    if (place >= counts.size()) counts.resize(place + 1);
    ++counts[place];
  }
}

bool ScanInserter::is_ready(const Waiting& waiting) const {
  const double time = waiting.scan.time;
  if (waiting.sensor != nullptr && !waiting.sensor->board.empty() &&
      !boards_.is_settled(waiting.sensor->board, time)) {
    return false;
  }
  return held_.is_settled(time);
}

void ScanInserter::release() {
  while (!waiting_.empty() && (waiting_.size() > most_waiting || is_ready(waiting_.front()))) {
    insert(waiting_.front());
    waiting_.pop_front();
  }
}

void ScanInserter::finish() {
  for (Waiting& waiting : waiting_) insert(waiting);
  waiting_.clear();
  for (const auto& [sensor, ranges] : laser_ranges_)
    if (const std::string spike = range_spike(sensor, ranges); !spike.empty())
      counts_.range_spikes.push_back(spike);
}

/// map_from_sensor when the scan was taken.
std::optional<Eigen::Isometry3d> ScanInserter::place(const Waiting& waiting) const {
  const SensorSetup* sensor = waiting.sensor;
  if (sensor == nullptr) return waiting.scan.map_from_sensor;
  if (!sensor->link.empty()) return place_on_robot(*sensor, waiting.scan.time);
  if (sensor->poses.empty() && sensor->board.empty()) return sensor->mount;
  const auto carrier = sensor->board.empty() ? streams_.at(sensor->name).at(waiting.scan.time)
                                             : boards_.at(sensor->board, waiting.scan.time);
  if (!carrier) return std::nullopt;
  return *carrier * sensor->mount;
}

/// The same of a sensor on the robot, where latency and readings of the joints leave less than half a voxel
/// at 1 m open.
std::optional<Eigen::Isometry3d> ScanInserter::place_on_robot(const SensorSetup& sensor, double time) const {
  const auto poses = moving_robot_->poses(time);
  const int link = links_.at(sensor.name);
  if (!poses || !moving_robot_->knows(time, link)) return std::nullopt;
  const Robot& robot = moving_robot_->robot();
  const Eigen::Isometry3d link_from_sensor =
      sensor.link == "tip" ? robot.link_from_tip * sensor.mount : sensor.mount;
  const auto [shift, turn] = moving_robot_->motion(time, link, link_from_sensor.translation());
  if (shift + turn * 1.0 > 0.5 * map_.options().resolution) return std::nullopt;
  return (*poses)[static_cast<std::size_t>(link)] * link_from_sensor;
}

void ScanInserter::insert(Waiting& waiting) {
  const Stopwatch watch(counts_.insert_s);
  const auto map_from_sensor = place(waiting);
  if (!map_from_sensor) {
    ++counts_.scans_without_pose;
    return;
  }
  Scan& scan = waiting.scan;
  const HeldBodies::Visibility visibility = held_.visibility(scan.time);
  scan.map_from_sensor = *map_from_sensor;
  if (observer_ != nullptr) observer_->see(scan);
  if (moving_robot_ != nullptr) {
    const MovingRobot::TakenOut own = moving_robot_->take_out(scan, waiting.times);
    if (!own.unknown.empty()) {
      if (counts_.scans_without_joints++ == 0) counts_.joint_gap = own.unknown;
      return;
    }
    counts_.points.dropped_filter += own.points;
  }
  if (visibility == HeldBodies::Visibility::hidden) {
    ++counts_.scans_probe_hidden;
    return;
  }
  ScanFilter filter = filter_of(setup_.map);
  if (scan.has_hits_only)
    filter.min_range = filter.max_range = 0.0;  // of no sensor
  else
    require_metres(scan, setup_.map);
  filter.bodies = robot_;
  if (visibility == HeldBodies::Visibility::unseen) ++counts_.scans_without_probe;
  for (const Capsule& body : held_.bodies(scan.time)) filter.bodies.push_back(body);
  const ScanCounts done = map_.insert(scan, filter);
  ++counts_.scans_inserted;
  counts_.scan_origin_sum += scan.map_from_sensor.translation();
  counts_.points.inserted += done.inserted;
  counts_.points.beyond_range += done.beyond_range;
  counts_.points.dropped_invalid += done.dropped_invalid + waiting.unusable;
  counts_.points.dropped_filter += done.dropped_filter;
  counts_.points.cleared += done.cleared;
  counts_.scans_refused += done.origin_invalid ? 1 : 0;
}

}  // namespace clearway
