#include "apps/sensed_spaces.hpp"

#include <locale>
#include <sstream>
#include <stdexcept>

#include "apps/suite_scans.hpp"
#include "apps/suite_teams.hpp"

namespace clearway {
namespace {

/// With OctoMap's 0.7 a voxel that was seen free for long is not occupied before its third hit: an obstacle
/// would be known three scans late. With this, the first hit tells, and with more where other sensors may
/// pass through the same voxel and miss.
constexpr double hit_probability = 0.9;

/// What robots know before anything is seen.
Snapshot known_before(const SuiteWorld& world, const Snapshot& map, const SuiteSensing& sensing) {
  return world.name.empty() ? FreeSpaceMap({.resolution = sensing.resolution}).snapshot() : map;
}

/// The voxels of a loaded map that sensors see, wherever one stands.
std::shared_ptr<const BlockedSpace> occupied_voxels(const Snapshot& map, const SuiteSensing& sensing) {
  Eigen::AlignedBox3d seen;
  for (const Eigen::Vector3d& sensor : sensing.sensors) {
    seen.extend(Eigen::Vector3d(sensor.array() - sensing.range));
    seen.extend(Eigen::Vector3d(sensor.array() + sensing.range));
  }
  return map.blocked_space({Policy::not_occupied}, seen, map.resolution());
}

}  // namespace

void check_sensors(const SuiteSensing& sensing, const Snapshot& map) {
  for (std::size_t i = 0; i < sensing.sensors.size(); ++i) {
    const Eigen::Vector3d& at = sensing.sensors[i];
    if (allows({Policy::not_occupied}, map.state(at), 0)) continue;
    std::ostringstream place;
    place.imbue(std::locale::classic());
    place << at.x() << ", " << at.y() << ", " << at.z();
    throw std::invalid_argument(
        "field 'sensing': sensor " + std::to_string(i + 1) + " at (" + place.str() +
        ") stands in an occupied voxel, expected a place from which something is seen");
  }
}

SensedSpaces::SensedSpaces(const Team& team, const std::vector<SuiteMoving>& moving,
                           const SuiteSensing& sensing, const SuiteWorld& world, const Snapshot& map,
                           const std::map<std::string, std::string>& policies)
    : team_(team),
      moving_(moving),
      sensing_(sensing),
      policies_(policies),
      solids_(world.solids),
      fused_(known_before(world, map, sensing),
             {.hit_probability =
                  telling_hit_probability(map, hit_probability, static_cast<int>(sensing.sensors.size()) - 1),
              .discretize = true}),
      latest_(fused_.snapshot()) {
  check_sensors(sensing, latest_);
  if (!world.map.empty()) occupied_ = occupied_voxels(latest_, sensing);
  for (const Eigen::Vector3d& place : sensing.sensors) {
    Sensor& sensor = sensors_.emplace_back(place);
    if (occupied_) sensor.still = scan_voxels(*occupied_, place, sensing.range, latest_.resolution());
  }
  look(0.0);
  seen_.front().time = 0.0;
}

/// What one sensor sees now.
Scan SensedSpaces::scan(const Sensor& sensor, const std::vector<SceneShape>& moving) const {
  if (occupied_)
    return scan_solids_before(sensor.still, moving, *occupied_, sensing_.range, latest_.resolution());
  std::vector<SceneShape> solids = solids_;
  solids.insert(solids.end(), moving.begin(), moving.end());
  return scan_solids(solids, sensor.place, sensing_.range, latest_.resolution());
}

/// All sensors look at the world as it is at `time`.
void SensedSpaces::look(double time) {
  std::vector<SceneShape> moving;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    if (!moving_[i].is_sensed) continue;
    SceneShape& shape = moving.emplace_back(moving_[i].shape);
    shape.map_from_shape = team_.obstacles[i].motion.pose(time);
  }
  for (const Sensor& sensor : sensors_) fused_.insert(scan(sensor, moving), {.max_range = sensing_.range});
  latest_ = fused_.snapshot();
  Seen& seen = seen_.emplace_back();
  seen.time = time + sensing_.latency;
  for (const TeamRobot& robot : team_.robots) {
    const Robot& own = robot.space->robot();
    seen.spaces.push_back(
        std::make_shared<const ConfigurationSpace>(own, latest_, team_policies(own, latest_, policies_)));
  }
  ++scans_;
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
  return seen_.front().spaces[robot];
}

}  // namespace clearway
