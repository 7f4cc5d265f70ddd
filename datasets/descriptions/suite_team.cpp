#include "datasets/descriptions/suite_team.hpp"

#include <cmath>
#include <set>

#include "datasets/descriptions/query_fields.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {
namespace {

constexpr double fastest = 1000.0;  ///< m/s, of things that move
constexpr double briefest = 1e-3;   ///< s, between two of their poses

SuiteTeamRobot read_team_robot(const YamlFields& fields, const std::filesystem::path& folder) {
  SuiteTeamRobot robot;
  robot.name = fields.text("name");
  robot.robot = fields.robot("robot", folder);
  robot.scale = fields.optional_number("scale", robot_scales);
  robot.payload = fields.number("payload", not_negative, robot.payload);
  if (fields.has_angles("base")) robot.map_from_base = fields.pose("base");
  robot.start = fields.angles("start");
  if (!fields.has_angles("goal")) fields.fail("goal", "expected where robot '" + robot.name + "' shall go");
  robot.goal = fields.angles("goal");
  fields.finish();
  return robot;
}

/// {time, pose}; the way of a shape.
SuiteMoving::Pose read_timed_pose(const YamlFields& fields) {
  SuiteMoving::Pose pose{fields.number("time", not_negative), fields.pose("pose")};
  fields.finish();
  return pose;
}

/// From one pose of a way to the next.
void check_leg(const SuiteMoving::Pose& from, const SuiteMoving::Pose& to, const YamlFields& fields) {
  const double time = to.time - from.time;
  if (!(time > 0.0)) fields.fail("time", "expected a time later than the one before");
  if (time < briefest * (1.0 - 1e-9)) fields.fail("time", "expected at least 1 ms after the one before");
  const double way = (to.map_from_shape.translation() - from.map_from_shape.translation()).norm();
  if (way > fastest * time) fields.fail("pose", "expected no more than 1000 m/s from the one before");
}

SuiteMoving read_moving(const YamlFields& fields) {
  SuiteMoving moving;
  moving.shape = read_scene_shape(fields.map("shape"));
  for (const auto& entry : fields.list_of_maps("path")) {
    moving.path.push_back(read_timed_pose(entry));
    if (moving.path.size() > 1) check_leg(moving.path[moving.path.size() - 2], moving.path.back(), entry);
  }
  if (moving.path.empty()) fields.fail("path", "expected at least one {time, pose}");
  if (fields.map("shape").has_angles("pose"))
    fields.fail("shape", "expected no pose: the path says where it is");
  moving.repeats = fields.has("repeats") && fields.boolean("repeats");
  if (moving.repeats && !moving.path.back().map_from_shape.isApprox(moving.path.front().map_from_shape, 1e-9))
    fields.fail("repeats", "expected a path that ends where it starts");
  moving.is_sensed = fields.has("sensed") && fields.boolean("sensed");
  fields.finish();
  return moving;
}

SuiteSensing read_sensing(const YamlFields& fields) {
  SuiteSensing sensing;
  for (const auto& at : fields.lists_of_numbers("sensors", within_reach, 3))
    sensing.sensors.emplace_back(at.data());
  if (sensing.sensors.empty()) fields.fail("sensors", "expected at least one [x, y, z]");
  sensing.range = fields.number("range", above_zero, sensing.range);
  sensing.resolution = fields.number("resolution", {1e-4, 100}, sensing.resolution);
  sensing.rate_hz = fields.number("rate_hz", {1e-3, 1e3}, sensing.rate_hz);
  sensing.latency = fields.number("latency", {0, 60}, sensing.latency);
  fields.finish();
  return sensing;
}

SuiteTeam read_team(const YamlFields& fields, const std::filesystem::path& folder) {
  SuiteTeam team;
  team.name = fields.text("name");
  std::set<std::string> names;
  for (const auto& entry : fields.list_of_maps("robots")) {
    team.robots.push_back(read_team_robot(entry, folder));
    take_name(names, team.robots.back().name, entry, "name");
  }
  if (team.robots.empty()) fields.fail("robots", "expected at least one robot");
  for (const auto& entry : fields.list_of_maps("moving")) {
    team.moving.push_back(read_moving(entry));
    take_name(names, team.moving.back().shape.name, entry, "shape");
  }
  fields.finish();
  return team;
}

}  // namespace

SuiteTeams read_suite_teams(const YamlFields& fields, const std::filesystem::path& folder) {
  SuiteTeams all;
  std::set<std::string> names;
  for (const auto& entry : fields.list_of_maps("teams")) {
    all.teams.push_back(read_team(entry, folder));
    take_name(names, all.teams.back().name, entry, "name");
  }
  if (fields.has("sensing")) all.sensing = read_sensing(fields.map("sensing"));
  for (const SuiteTeam& team : all.teams)
    for (const SuiteMoving& moving : team.moving)
      if (moving.is_sensed && !all.sensing)
        fields.fail("sensing", "expected sensors, or nobody sees '" + moving.shape.name + "' of team '" +
                                   team.name + "'");
  if (fields.has("teams") && all.teams.empty()) fields.fail("teams", "expected at least one team");
  all.period = fields.number("period", {1e-4, 1}, all.period);
  all.duration = fields.number("duration", {1e-3, 3600}, all.duration);
  all.max_acceleration = fields.number("max_acceleration", above_zero, all.max_acceleration);
  return all;
}

}  // namespace clearway
