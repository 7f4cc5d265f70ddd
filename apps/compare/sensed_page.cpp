#include "apps/compare/sensed_page.hpp"

#include <algorithm>
#include <cmath>

#include "apps/console/parse.hpp"
#include "planning/constraint/obstacle_constraints.hpp"

namespace clearway {
namespace {

/// The step that a waypoint of the page shows.
std::size_t step_of(const PagePlan& plan, const TeamRun& run, std::size_t waypoint) {
  if (waypoint + 1 >= plan.waypoints.size()) return run.steps();
  return static_cast<std::size_t>(std::llround(static_cast<double>(waypoint) * plan.period / run.period));
}

/// Least distance of all robots from what is sensed, at most d_i; certified.
double true_separation(const Team& team, const TeamRun& run, std::size_t step) {
  double least = run.figures.influence_distance;
  const double time = static_cast<double>(step) * run.period;
  for (std::size_t i = 0; i < team.robots.size(); ++i) {
    const Robot& robot = team.robots[i].space->robot();
    const auto bodies = placed_bodies(robot, forward_kinematics(robot, run.traces[i].positions[step]));
    for (const MovingObstacle& obstacle : team.obstacles) {
      if (!obstacle.is_sensed) continue;
      const Eigen::Isometry3d pose = obstacle.motion.pose(time);
      for (const PlacedShape& body : bodies)
        least = std::min(least, distance(body.shape, body.pose, obstacle.shape, pose, least).lower);
    }
  }
  return least;
}

std::string milliseconds(double seconds) { return significant(1000.0 * seconds, 3) + " ms"; }

}  // namespace

void show_sensed(PagePlan& plan, const Team& team, const TeamRun& run, const SensedSpaces& spaces) {
  plan.seen_voxel = spaces.map_before().resolution();
  for (const SeenAnew& seen : spaces.seen_anew()) plan.seen.push_back({seen.time, seen.voxels});
  for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
    const std::size_t step = step_of(plan, run, i);
    plan.map_age.push_back(spaces.ages()[step]);
    plan.true_separation.push_back(true_separation(team, run, step));
  }
  const double oldest = *std::max_element(spaces.ages().begin(), spaces.ages().end());
  plan.figures.emplace_back("age of the map", "up to " + milliseconds(oldest));
  // What comes right after a scan is in the next one, which is known when the map is oldest.
  plan.figures.emplace_back("reaction within", milliseconds(oldest + run.period));
  plan.figures.emplace_back("changes of the map", std::to_string(spaces.seen_anew().size()));
}

}  // namespace clearway
