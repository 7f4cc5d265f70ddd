// Plans a motion of an arm through painted space and has it proved by code that no planner shares.
//
// The tool of a PUMA 560 must stay where somebody painted, with a pillar on the straight way.

#include <iostream>
#include <mapping/free_space_map.hpp>
#include <memory>
#include <planning/beam/beam.hpp>
#include <planning/path/trajectory.hpp>
#include <planning/plan_and_check.hpp>
#include <planning/robot_files/load_robot.hpp>

using namespace clearway;

Configuration with_base_at(double turn) {
  Configuration q(6);
  q << turn, -0.8, 0.3, 0.0, 0.4, 0.0;  // radians
  return q;
}

/// What a camera sees, and paint along the arc that the tool's tip takes when the base turns, and above it.
Snapshot painted_arcs(const Robot& robot) {
  FreeSpaceMap map({.resolution = 0.03});
  const int volume = map.add_volume("arcs", robot.critical_parts);
  for (double turn = -0.7; turn <= 0.7; turn += 0.02) {
    const Eigen::Vector3d tip = tip_pose(robot, with_base_at(turn)).translation();
    map.paint(volume, {.center = tip, .radius = 0.22});
    map.paint(volume, {.center = tip + Eigen::Vector3d(0.0, 0.0, 0.25), .radius = 0.22});
  }
  // The camera looks against the map's x axis: a wall at x = -1 m, before it a pillar as high as the tip.
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(2.0, 0.0, 0.8);
  const Eigen::Vector3d top = tip_pose(robot, with_base_at(0.0)).translation();
  for (double y = -1.5; y <= 1.5; y += 0.02) {
    for (double z = -0.5; z <= 2.0; z += 0.02) scan.points.emplace_back(-3.0f, y, z - 0.8);
  }
  for (double z = 0.0; z <= top.z(); z += 0.01) scan.points.emplace_back(top.x() - 2.0, 0.0, z - 0.8);
  map.insert(scan);
  return map.snapshot();
}

int main() {
  const Robot robot = load_robot("puma560");
  const Snapshot map = painted_arcs(robot);
  const Configuration start = with_base_at(-0.6), goal = with_base_at(0.6);

  const ConfigurationSpace space(robot, map, {}, {.padding = robot.position_accuracy});
  const Plan plan = plan_and_check({.space = space, .start = start, .goals = {goal}});
  std::cout << "status: " << to_string(plan.status()) << '\n'
            << "proved: " << (plan.is_proved() ? "yes" : "no, " + plan.validation.first_contact) << '\n';

  // Each planner's options are a struct; goals are visited in turn.
  const auto beam = std::make_shared<Beam>(BeamOptions{.width = 20, .step_deg = {2.0}});
  const Plan there_and_back =
      plan_and_check({.space = space, .start = start, .goals = {goal, start}, .planner = beam});
  std::cout << "there and back with a beam of width " << there_and_back.options.at("width") << ": "
            << (there_and_back.is_proved() ? "proved" : there_and_back.explanation()) << '\n';

  // What the map forbids is an outcome, not an exception.
  const Plan refused = plan_and_check({.space = space, .start = start, .goals = {with_base_at(1.5)}});
  std::cout << "goal beyond the paint: " << to_string(refused.status()) << '\n'
            << refused.explanation() << '\n';
  if (!plan.is_proved() || !there_and_back.is_proved()) return 1;

  // A proved path is given time, within the joints' limits.
  const Trajectory motion = time_parameterize(robot, plan.waypoints());
  const LimitShares shares = limit_shares(robot, motion);
  const bool keeps_limits = shares.velocity <= 1.0 + 1e-9 && shares.acceleration <= 1.0 + 1e-9;
  std::cout << "motion of " << motion.points.back().time << " s, joint limits "
            << (keeps_limits ? "kept\n" : "NOT kept\n");
  const bool arrives = motion.points.back().position == goal;
  return keeps_limits && arrives && refused.status() == PlanStatus::goal_invalid ? 0 : 1;
}
