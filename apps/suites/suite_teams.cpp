#include "apps/suites/suite_teams.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/query/query.hpp"
#include "apps/suites/suite_cells.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/joined_robot.hpp"

namespace clearway {
namespace {

TeamRobot make_robot(const SuiteTeamRobot& given, const Snapshot& map,
                     const std::map<std::string, std::string>& policies) {
  Robot robot = choose_robot({.robot = given.robot, .scale = given.scale, .base = {}, .policies = {}});
  if (given.map_from_base) robot.map_from_base = *given.map_from_base;
  if (given.start.size() != robot.dof() || given.goal.size() != robot.dof()) {
    throw std::invalid_argument("start and goal: got " + std::to_string(given.start.size()) + " and " +
                                counted(given.goal.size(), "value") + ", expected " +
                                std::to_string(robot.dof()) + " each (robot '" + robot.name + "')");
  }
  const Policies chosen = team_policies(robot, map, policies);
  auto space = std::make_shared<const ConfigurationSpace>(std::move(robot), map, chosen);
  return {given.name, std::move(space), configuration(given.start), configuration(given.goal)};
}

}  // namespace

Policies team_policies(const Robot& robot, const Snapshot& map,
                       const std::map<std::string, std::string>& given) {
  Policies policies;
  if (map.volumes().empty()) policies.critical_by_default = false;
  for (const auto& [part, policy] : given) {
    if (part == "default") {
      policies.other = parse_policy(policy);
      policies.critical_by_default = false;
      continue;
    }
    const bool has_part = std::any_of(robot.bodies.begin(), robot.bodies.end(),
                                      [&part = part](const Body& body) { return body.part == part; });
    if (has_part) policies.parts[part] = parse_policy(policy);
  }
  return policies;
}

Team make_team(const SuiteTeam& given, const Snapshot& map,
               const std::map<std::string, std::string>& policies) {
  Team team;
  for (const SuiteTeamRobot& robot : given.robots) {
    try {
      team.robots.push_back(make_robot(robot, map, policies));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("team '" + given.name + "', robot '" + robot.name + "': " + error.what());
    }
  }
  for (const SuiteMoving& moving : given.moving) {
    std::vector<TimedPose> poses;
    for (const SuiteMoving::Pose& pose : moving.path) poses.push_back({pose.time, pose.map_from_shape});
    team.obstacles.push_back({moving.shape.name, shape_of(moving.shape),
                              RigidMotion(std::move(poses), moving.repeats), moving.is_sensed});
  }
  return team;
}

Snapshot empty_map() { return FreeSpaceMap({.resolution = 0.05}).snapshot(); }

}  // namespace clearway
