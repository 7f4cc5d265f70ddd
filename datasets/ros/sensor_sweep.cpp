#include "datasets/ros/sensor_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "datasets/ros/sensor_frames.hpp"

namespace clearway {
namespace {

constexpr double most_parts = 32.0;

/// A return, and where the laser was then.
struct PlacedReturn {
  LaserReturn seen;
  Eigen::Isometry3d world_from_laser;
};

/// m, of the laser between the first and the last return.
double way_of(const std::vector<PlacedReturn>& returns) {
  double way = 0.0;
  for (std::size_t i = 1; i < returns.size(); ++i)
    way += (returns[i].world_from_laser.translation() - returns[i - 1].world_from_laser.translation()).norm();
  return way;
}

/// Where a return is in the laser's axes at another time.
Eigen::Vector3f moved(const PlacedReturn& one, const Eigen::Isometry3d& world_from_laser) {
  if (one.world_from_laser.matrix() == world_from_laser.matrix()) return one.seen.point;
  return (world_from_laser.inverse() * (one.world_from_laser * one.seen.point.cast<double>())).cast<float>();
}

}  // namespace

std::vector<Frame> frames_of_sweep(const RosLaserScan& scan, const std::string& sensor, double time,
                                   double most_way, bool with_clear,
                                   const std::function<Eigen::Isometry3d(double time)>& world_from_laser) {
  const double increment = double{scan.time_increment};
  const std::size_t rays = scan.ranges.size();
  if (!std::isfinite(increment) || std::abs(increment) * static_cast<double>(rays) > longest_sweep)
    throw std::runtime_error("its time increment is not sound: expected a sweep of 60 s at most");
  const auto time_of = [&](std::size_t ray) { return time + increment * static_cast<double>(ray); };
  std::vector<PlacedReturn> returns;
  for (const LaserReturn& one : laser_returns(scan, with_clear))
    returns.push_back({one, world_from_laser(time_of(one.ray))});
  const auto parts =
      static_cast<std::size_t>(std::clamp(std::ceil(way_of(returns) / most_way), 1.0, most_parts));
  std::vector<Frame> frames;
  auto next = returns.begin();
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = rays * part / parts, end = rays * (part + 1) / parts;
    const auto first = std::exchange(next, std::find_if(next, returns.end(), [&](const PlacedReturn& one) {
                                       return one.seen.ray >= end;
                                     }));
    if (first == next && parts > 1) continue;
    CloudFrame cloud = empty_laser_cloud(scan);
    if (!frames.empty()) cloud.infinite = cloud.at_range = 0;  // counted once
    cloud.world_from_sensor = world_from_laser(time_of((begin + end) / 2));
    const double since = time_of(increment < 0.0 && end > begin ? end - 1 : begin);
    for (const PlacedReturn& one : std::span(first, next)) {
      (one.seen.is_clear ? cloud.clear_to : cloud.points).push_back(moved(one, cloud.world_from_sensor));
      if (!one.seen.is_clear) cloud.times.push_back(static_cast<float>(time_of(one.seen.ray) - since));
    }
    frames.push_back({since, sensor, std::move(cloud)});
  }
  if (increment < 0.0) std::reverse(frames.begin(), frames.end());
  return frames;
}

std::vector<Frame> frames_of_timed_cloud(
    const CloudFrame& cloud, const std::vector<double>& times, const std::string& sensor, double most_way,
    const std::function<Eigen::Isometry3d(double time)>& world_from_sensor) {
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return times[a] < times[b]; });
  constexpr double step = 1e-4;          // s that share a pose
  std::vector<Eigen::Isometry3d> poses;  // of the points in order
  double way = 0.0, at = -HUGE_VAL;
  for (const std::size_t point : order) {
    if (times[point] - at > step) {
      at = times[point];
      const Eigen::Isometry3d pose = world_from_sensor(at);
      if (!poses.empty()) way += (pose.translation() - poses.back().translation()).norm();
      poses.push_back(pose);
    } else {
      poses.push_back(poses.back());
    }
  }
  const double parts = std::clamp(std::ceil(way / most_way), 1.0, most_parts);
  const double first = times[order.front()], span = times[order.back()] - first;
  std::vector<Frame> frames;
  std::size_t next = 0;
  for (double part = 0.0; part < parts; part += 1.0) {
    const double end = first + span * (part + 1.0) / parts;
    CloudFrame taken;
    taken.kind = cloud.kind;
    taken.max_range = cloud.max_range;
    taken.unusable = frames.empty() ? cloud.unusable : 0;
    taken.world_from_sensor = world_from_sensor(first + span * (part + 0.5) / parts);
    const Eigen::Isometry3d sensor_from_world = taken.world_from_sensor.inverse();
    const std::size_t begin = next;
    for (; next < order.size() && (part + 1.0 >= parts || times[order[next]] < end); ++next) {
      const std::size_t point = order[next];
      taken.points.push_back(
          (sensor_from_world * (poses[next] * cloud.points[point].cast<double>())).cast<float>());
      taken.times.push_back(static_cast<float>(times[point] - times[order[begin]]));
    }
    if (next > begin) frames.push_back({times[order[begin]], sensor, std::move(taken)});
  }
  return frames;
}

}  // namespace clearway
