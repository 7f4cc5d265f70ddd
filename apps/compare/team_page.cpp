#include "apps/compare/team_page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/console/parse.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/pages/plan_motion.hpp"
#include "planning/robot/joined_robot.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Robot joined_robot_of(const Team& team) {
  std::vector<std::pair<std::string, Robot>> robots;
  for (const TeamRobot& robot : team.robots) robots.emplace_back(robot.name, robot.space->robot());
  return joined_robot(robots);
}

/// The least that any robot saw from sample `first` on, before sample `end`, m.
double least_separation(const TeamRun& run, std::size_t first, std::size_t end) {
  double least = run.figures.influence_distance;
  for (const TeamTrace& trace : run.traces)
    for (std::size_t k = first; k < std::min(end, trace.separations.size()); ++k)
      least = std::min(least, trace.separations[k]);
  return least;
}

Configuration joined_at(const TeamRun& run, std::size_t k) {
  std::vector<Configuration> all;
  for (const TeamTrace& trace : run.traces) all.push_back(trace.positions[k]);
  return joined(all);
}

/// Links of all robots, then the obstacles.
std::vector<Eigen::Isometry3d> poses_of(const Team& team, const Robot& robot, const Configuration& q,
                                        double time) {
  std::vector<Eigen::Isometry3d> poses = forward_kinematics(robot, q);
  for (const MovingObstacle& obstacle : team.obstacles) poses.push_back(obstacle.motion.pose(time));
  return poses;
}

Configuration ends(const Team& team, bool at_goal) {
  std::vector<Configuration> all;
  for (const TeamRobot& robot : team.robots) all.push_back(at_goal ? robot.goal : robot.start);
  return joined(all);
}

std::string millimetres(double metres) { return significant(1000.0 * metres) + " mm"; }

Json pose_json(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

Json json_numbers(const Eigen::VectorXd& q) { return std::vector<double>(q.begin(), q.end()); }

Json robot_json(const TeamRobot& robot, const TeamTrace& trace) {
  Json joints = Json::array(), positions = Json::array();
  for (const Joint& joint : robot.space->robot().joints) joints.push_back(joint.name);
  for (const Configuration& q : trace.positions) positions.push_back(json_numbers(q));
  return {{"name", robot.name},
          {"robot", robot.space->robot().name},
          {"base", pose_json(robot.space->robot().map_from_base)},
          {"joints", joints},
          {"start", json_numbers(robot.start)},
          {"goal", json_numbers(robot.goal)},
          {"arrival_s", trace.arrival >= 0.0 ? Json(trace.arrival) : Json(nullptr)},
          {"deadlocks", trace.deadlocks},
          {"constraint_switches", trace.switches},
          {"steps_over_acceleration", trace.accelerated},
          {"steps_relaxed", trace.relaxed},
          {"positions", positions},
          {"separations_m", trace.separations}};
}

}  // namespace

ReportPage page_of_team(const Team& team, const Snapshot& map, const std::string& title) {
  ReportPage page = page_of_map(MapLeaves(map), title);
  const Robot robot = joined_robot_of(team);
  const Configuration start = ends(team, false);
  show_robot(page, robot, start);
  std::size_t body = 0;
  for (std::size_t i = 0; i < team.robots.size(); ++i) {
    const std::size_t count = team.robots[i].space->robot().bodies.size();
    for (std::size_t b = 0; b < count; ++b) page.robot[body++].group = static_cast<int>(i);
  }
  for (std::size_t o = 0; o < team.obstacles.size(); ++o) {
    PageShape& shape = page.robot.emplace_back(page_shape(team.obstacles[o].shape));
    shape.link = static_cast<int>(robot.links.size() + o);
    shape.part = team.obstacles[o].name;
    shape.group = team.obstacles[o].is_sensed ? -2 : -1;
  }
  page.robot_home = poses_of(team, robot, start, 0.0);
  return page;
}

PagePlan page_of_run(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                     const CompareRun& found, double max_acceleration, const std::string& label) {
  const Robot robot = joined_robot_of(team);
  PagePlan plan;
  plan.name = label;
  plan.status = to_string(run.status);
  plan.explanation = run.explanation;
  if (found.check == "refused") plan.status = "refused by the check";
  if (found.check == "outrun") plan.status = "outrun";
  if (found.check == "refused") plan.explanation += " The check: " + found.contact + ".";
  if (found.check == "outrun" && verdict.least_separation <= 0.0)
    plan.explanation += " The check: " + verdict.between + " touch at " + significant(verdict.time) + " s.";
  for (const Joint& joint : robot.joints) {
    plan.joints.push_back(joint.name);
    plan.is_prismatic.push_back(joint.kind == JointKind::prismatic);
  }
  std::vector<Configuration> positions;
  std::vector<Eigen::VectorXd> velocities;
  for (std::size_t k = 0; k <= run.steps(); ++k) {
    positions.push_back(joined_at(run, k));
    velocities.push_back((positions[k] - positions[k > 0 ? k - 1 : 0]) / run.period);
  }
  plan.security_distance = run.figures.security_distance;
  const auto shown = show_motion(plan, robot, positions, velocities, run.period, max_acceleration);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double time = static_cast<double>(shown[i]) * run.period;
    plan.link_poses.push_back(poses_of(team, robot, positions[shown[i]], time));
    plan.clearance.push_back(
        least_separation(run, shown[i], i + 1 < shown.size() ? shown[i + 1] : shown[i] + 1));
  }
  plan.start_poses = poses_of(team, robot, ends(team, false), 0.0);
  plan.goal_poses = poses_of(team, robot, ends(team, true), 0.0);
  plan.figures = {
      {"motion", significant(static_cast<double>(run.steps()) * run.period) + " s"},
      {"period", significant(1000.0 * run.period) + " ms"},
      {"least separation",
       (verdict.between.empty() ? "at least " : "") + millimetres(verdict.least_separation)},
      {"between", verdict.between.empty() ? "-" : verdict.between},
      {"security distance", millimetres(run.figures.security_distance)},
      {"influence distance", millimetres(run.figures.influence_distance)},
      {"top joint speed", significant(100.0 * verdict.greatest_speed_share, 3) + " % of limit"},
      {"top acceleration", significant(100.0 * verdict.greatest_acceleration_share, 3) + " % of limit"}};
  return plan;
}

std::string team_json(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                      const std::string& planner, const PlannerOptions& options) {
  Json robots = Json::array(), obstacles = Json::array();
  for (std::size_t i = 0; i < run.traces.size(); ++i)
    robots.push_back(robot_json(team.robots[i], run.traces[i]));
  for (const MovingObstacle& obstacle : team.obstacles) {
    Json poses = Json::array();
    for (std::size_t k = 0; k <= run.steps(); ++k)
      poses.push_back(pose_json(obstacle.motion.pose(static_cast<double>(k) * run.period)));
    obstacles.push_back({{"name", obstacle.name}, {"poses", poses}});
  }
  const Json all{{"planner", planner},
                 {"options", options},
                 {"status", to_string(run.status)},
                 {"explanation", run.explanation},
                 {"period_s", run.period},
                 {"influence_distance_m", run.figures.influence_distance},
                 {"security_distance_m", run.figures.security_distance},
                 {"own_security_distance_m", run.figures.own_security_distance},
                 {"xi_m", run.figures.xi},
                 {"max_step", run.figures.max_step},
                 {"greatest_obstacle_speed_m_s", run.figures.greatest_obstacle_speed},
                 {"step_bound_m", run.step_bound()},
                 {"outrun", run.outrun},
                 {"check",
                  {{"is_apart", verdict.is_apart},
                   {"least_separation_m", verdict.least_separation},
                   {"at_s", verdict.time},
                   {"between", verdict.between},
                   {"contact", verdict.contact},
                   {"greatest_speed_share", verdict.greatest_speed_share},
                   {"greatest_acceleration_share", verdict.greatest_acceleration_share}}},
                 {"robots", robots},
                 {"obstacles", obstacles}};
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace clearway
