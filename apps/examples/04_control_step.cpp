// Moves an arm by control steps: each is the step nearest to the wanted one that keeps its distance from all
// that is near (Lahouar et al. 2006). It takes microseconds and looks no step ahead.
//
// A PUMA 560 turns its base towards a wall that it cannot pass, and stands before it.

#include <algorithm>
#include <iostream>
#include <mapping/free_space_map.hpp>
#include <planning/constraint/control_step.hpp>
#include <planning/robot_files/load_robot.hpp>

using namespace clearway;

/// A wall at y = 0.4 m, seen from the robot's side of it.
Snapshot wall() {
  FreeSpaceMap map({.resolution = 0.02});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.8, -0.6, 0.6);
  for (float x = -0.8f; x <= 0.8f; x += 0.01f) {
    for (float z = -0.6f; z <= 0.8f; z += 0.01f) scan.points.push_back({x, 1.01f, z});
  }
  map.insert(scan);
  return map.snapshot();
}

int main() {
  const Robot robot = load_robot("puma560");
  const Policies unknown_is_free{.other = Policy::not_occupied, .critical_by_default = false};
  const ConfigurationSpace space(robot, wall(), unknown_is_free);

  const DamperOptions damper{.max_step = 0.01,            // rad a step, all joints together
                             .influence_distance = 0.15,  // m: nearer things limit the step
                             .security_distance = 0.03,   // m: here approach stops
                             .xi = 0.02,                  // m a step: approach allowed at the first distance
                             .weight = Eigen::VectorXd::Ones(6)};
  ControlStep control(space, damper);

  Configuration q(6), goal(6);
  q << -0.8, -0.8, 0.3, 0.0, 0.4, 0.0;
  goal = q;
  goal[0] = 1.2;  // beyond the wall
  const double way = (goal - q).norm();

  double nearest = damper.influence_distance, largest_step = 0.0;
  int steps = 0, slowed = 0;
  for (; steps < 1000; ++steps) {
    const Eigen::VectorXd wanted = step_to_goal(damper, q, goal);
    control.look(q);  // kinematics, and a row for each thing that is near
    const Eigen::VectorXd& step = control.solve(wanted);
    nearest = std::min(nearest, control.separation());
    largest_step = std::max(largest_step, step.norm());
    if (step.norm() < 0.5 * wanted.norm()) ++slowed;
    if (step.norm() < 1e-5) break;  // the wall holds it: a local method ends in a deadlock here
    q += step;                      // with weights of 1, weighted units are radians
  }

  const bool came_near = (goal - q).norm() < 0.8 * way;
  const bool kept_distance = nearest > damper.security_distance - 1e-3;
  const bool kept_speed = largest_step < damper.max_step + 1e-9;
  std::cout << "came towards the goal: " << (came_near ? "yes" : "no") << '\n'
            << "kept 3 cm from the wall: " << (kept_distance ? "yes" : "no") << '\n'
            << "no step longer than 0.01 rad: " << (kept_speed ? "yes" : "no") << '\n'
            << "slowed down before the wall: " << (slowed > 0 ? "yes" : "no") << '\n'
            << "configuration free: " << (space.is_free(q) ? "yes" : "no") << '\n'
            << steps << " steps\n";
  return came_near && kept_distance && kept_speed && slowed > 0 && space.is_free(q) ? 0 : 1;
}
