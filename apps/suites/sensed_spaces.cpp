#include "apps/suites/sensed_spaces.hpp"

#include <algorithm>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/suites/suite_teams.hpp"

namespace clearway {
namespace {

/// With OctoMap's 0.7 a voxel that was seen free for long is not occupied before its third hit: an obstacle
/// would be known three scans late. With this, the first hit decides, and with more where other sensors may
/// pass through the same voxel and miss.
constexpr double hit_probability = 0.9;

/// What robots know before anything is seen.
Snapshot known_before(const SuiteWorld& world, const Snapshot& map, const SuiteSensing& sensing) {
  return world.name.empty() ? FreeSpaceMap({.resolution = sensing.resolution}).snapshot() : map;
}

/// The voxels of a map that sensors see, wherever one stands.
std::shared_ptr<const BlockedSpace> occupied_voxels(const Snapshot& map, const SuiteSensing& sensing) {
  Eigen::AlignedBox3d seen;
  for (const Eigen::Vector3d& sensor : sensing.sensors) {
    seen.extend(Eigen::Vector3d(sensor.array() - sensing.range));
    seen.extend(Eigen::Vector3d(sensor.array() + sensing.range));
  }
  seen = seen.intersection(map.bounds());
  if (seen.isEmpty()) seen = Eigen::AlignedBox3d(sensing.sensors.front());
  return map.blocked_space({Policy::not_occupied}, seen, map.resolution());
}

bool is_blocked(const Snapshot& map, const Eigen::Vector3d& at) {
  return !allows({Policy::not_occupied}, map.state(at), 0);
}

bool is_below(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// "sensor 2 at (0.1, 0, 1.2)"
std::string sensor_text(const SuiteSensing& sensing, std::size_t i) {
  const Eigen::Vector3d& at = sensing.sensors[i];
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "sensor " << i + 1 << " at (" << at.x() << ", " << at.y() << ", " << at.z() << ")";
  return text.str();
}

/// When the point comes within a millimetre of the obstacle first, s; none: never.
std::optional<double> time_of_contact(const MovingObstacle& obstacle, const Eigen::Vector3d& point) {
  constexpr double near = 1e-3;
  const double speed = obstacle.greatest_speed(), end = obstacle.motion.poses().back().time;
  for (double time = 0.0;;) {
    const double apart = obstacle.shape.signed_distance(obstacle.motion.pose(time).inverse() * point);
    if (apart <= near) return time;
    if (time >= end) return {};
    time = speed > 0.0 ? std::min(end, time + apart / speed) : end;
  }
}

}  // namespace

void check_sensors(const SuiteSensing& sensing, const Snapshot& map) {
  for (std::size_t i = 0; i < sensing.sensors.size(); ++i) {
    if (is_blocked(map, sensing.sensors[i]))
      throw std::invalid_argument(
          sensor_text(sensing, i) +
          " stands in an occupied voxel, expected a place from which something is seen");
  }
}

void check_sensors(const SuiteSensing& sensing, const Team& team) {
  for (const MovingObstacle& obstacle : team.obstacles) {
    for (std::size_t i = 0; obstacle.is_sensed && i < sensing.sensors.size(); ++i) {
      if (const auto time = time_of_contact(obstacle, sensing.sensors[i]))
        throw std::invalid_argument(sensor_text(sensing, i) + " is met by '" + obstacle.name + "' at " +
                                    significant(*time, 3) + " s, expected a place beside its way");
    }
  }
}

SensedSpaces::SensedSpaces(const Team& team, const std::vector<SuiteMoving>& moving,
                           const SuiteSensing& sensing, const SuiteWorld& world, const Snapshot& map,
                           const std::map<std::string, std::string>& policies)
    : team_(team),
      moving_(moving),
      sensing_(sensing),
      policies_(policies),
      fused_(known_before(world, map, sensing),
             {.hit_probability = decisive_hit_probability(map, hit_probability,
                                                          static_cast<int>(sensing.sensors.size()) - 1),
              .discretize = false,
              .integration = Integration::compatible}),
      before_(fused_.snapshot()),
      latest_(before_) {
  check_sensors(sensing, before_);
  occupied_ = occupied_voxels(before_, sensing);
  for (const Eigen::Vector3d& place : sensing.sensors) add_sensor(place, world);
  look(0.0);
  seen_.front().time = seen_anew_.front().time = 0.0;
}

void SensedSpaces::add_sensor(const Eigen::Vector3d& place, const SuiteWorld& world) {
  const double range = sensing_.range, resolution = before_.resolution();
  SolidScan still{scan_voxels(*occupied_, place, range, resolution), 0};
  if (!world.solids.empty())
    still = scan_solids_before(still.scan, world.solids, *occupied_, range, resolution);
  for (std::size_t i = 0; i < still.on_solids; ++i)
    uncharted_.push_back(still.scan.map_from_sensor * still.scan.points[i].cast<double>());
  std::erase_if(uncharted_, [&](const Eigen::Vector3d& at) { return is_blocked(before_, at); });
  sensors_.push_back({place, std::move(still.scan)});
}

/// What is sensed of what moves, where it is then.
std::vector<SceneShape> SensedSpaces::moving_at(double time) const {
  std::vector<SceneShape> shapes;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    if (!moving_[i].is_sensed) continue;
    SceneShape& shape = shapes.emplace_back(moving_[i].shape);
    shape.map_from_shape = team_.obstacles[i].motion.pose(time);
  }
  return shapes;
}

/// All sensors look at the world as it is at `time`.
void SensedSpaces::look(double time) {
  const std::vector<SceneShape> moving = moving_at(time);
  std::vector<Eigen::Vector3d> places = uncharted_;
  for (const Sensor& sensor : sensors_) {
    const SolidScan seen =
        scan_solids_before(sensor.still, moving, *occupied_, sensing_.range, before_.resolution());
    for (std::size_t i = 0; i < seen.on_solids; ++i)
      places.push_back(seen.scan.map_from_sensor * seen.scan.points[i].cast<double>());
    fused_.insert(seen.scan, {.max_range = sensing_.range});
  }
  latest_ = fused_.snapshot();
  Seen& seen = seen_.emplace_back();
  seen.taken = time;
  seen.time = time + sensing_.latency;
  for (const TeamRobot& robot : team_.robots) {
    const Robot& own = robot.space->robot();
    seen.spaces.push_back(
        std::make_shared<const ConfigurationSpace>(own, latest_, team_policies(own, latest_, policies_)));
  }
  note_what_is_new(seen.time, std::move(places));
  ++scans_;
}

/// @param places where something may be new: rays ended there
void SensedSpaces::note_what_is_new(double time, std::vector<Eigen::Vector3d> places) {
  if (!seen_anew_.empty())
    places.insert(places.end(), seen_anew_.back().voxels.begin(), seen_anew_.back().voxels.end());
  for (Eigen::Vector3d& place : places) place = voxel_middle(place, before_.resolution());
  std::sort(places.begin(), places.end(), is_below);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  std::erase_if(places, [&](const Eigen::Vector3d& voxel) {
    return !is_blocked(latest_, voxel) || is_blocked(before_, voxel);
  });
  if (seen_anew_.empty() || seen_anew_.back().voxels != places)
    seen_anew_.push_back({time, std::move(places)});
}

/// Takes all scans that robots have by `time`.
void SensedSpaces::see_until(double time) {
  for (;;) {
    const double next = static_cast<double>(scans_) / sensing_.rate_hz;
    if (next + sensing_.latency > time) break;
    look(next);
  }
  while (seen_.size() > 1 && seen_[1].time <= time) seen_.pop_front();
}

std::shared_ptr<const ConfigurationSpace> SensedSpaces::at(std::size_t robot, double time) {
  see_until(time);
  if (robot == 0) ages_.push_back(time - seen_.front().taken);
  return seen_.front().spaces[robot];
}

}  // namespace clearway
