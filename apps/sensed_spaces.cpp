#include "apps/sensed_spaces.hpp"

#include "apps/suite_scans.hpp"
#include "apps/suite_teams.hpp"

namespace clearway {
namespace {

/// With OctoMap's 0.7 a voxel that was seen free for long is not occupied before its third hit: an obstacle
/// would be known three scans late. With this, the first hit tells.
constexpr double hit_probability = 0.9;

}  // namespace

SensedSpaces::SensedSpaces(const Team& team, const std::vector<SuiteMoving>& moving,
                           const SuiteSensing& sensing, const SuiteWorld& world,
                           const std::map<std::string, std::string>& policies)
    : team_(team),
      moving_(moving),
      sensing_(sensing),
      policies_(policies),
      solids_(world.solids),
      fused_({.resolution = world.name.empty() ? sensing.resolution : world.resolution,
              .hit_probability = hit_probability,
              .discretize = true}) {
  for (const Eigen::Vector3d& sensor : world.sensors)
    fused_.insert(scan_solids(solids_, sensor, world.sensor_range, world.resolution),
                  {.max_range = world.sensor_range});
  look(0.0);
  seen_.front().time = 0.0;
}

/// All sensors look at the world as it is at `time`.
void SensedSpaces::look(double time) {
  std::vector<SceneShape> solids = solids_;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    if (!moving_[i].is_sensed) continue;
    SceneShape& shape = solids.emplace_back(moving_[i].shape);
    shape.map_from_shape = team_.obstacles[i].motion.pose(time);
  }
  for (const Eigen::Vector3d& sensor : sensing_.sensors) {
    const double resolution = fused_.snapshot().resolution();
    fused_.insert(scan_solids(solids, sensor, sensing_.range, resolution), {.max_range = sensing_.range});
  }
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
