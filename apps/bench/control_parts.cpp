// What a control step consists of, judged part by part.

#include "apps/bench/control_parts.hpp"

#include <ctime>
#include <memory>
#include <numbers>

#include "apps/bench/peers/fcl_bodies.hpp"
#include "apps/bench/worlds/arm_damper.hpp"
#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/constraint/obstacle_constraints.hpp"

namespace clearway::bench {

double now_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double clock_us() {
  std::vector<double> took;
  for (int i = 0; i < 2000; ++i) {
    const double begin = now_us();
    took.push_back(now_us() - begin);
  }
  return median(took);
}

namespace {

struct Arm {
  std::unique_ptr<ConfigurationSpace> space;
  std::unique_ptr<ControlStep> control;
  std::unique_ptr<ObstacleConstraints> near;
  std::vector<PlacedShape> bodies;
  std::vector<ObstacleConstraint> constraints;
  Configuration q, goal;
};

std::vector<Arm> arms_in_a_ring(const Snapshot& map, const Robot& robot) {
  std::vector<Arm> arms(3);
  for (std::size_t i = 0; i < arms.size(); ++i) {
    Robot placed = robot;
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    placed.map_from_base.translation() = 0.52 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    arms[i].space = std::make_unique<ConfigurationSpace>(placed, map, Policies{.critical_by_default = false});
    DamperOptions options = arm_damper(robot, step_limit);
    options.xi /= 2.0;
    arms[i].control = std::make_unique<ControlStep>(*arms[i].space, options);
    arms[i].near = std::make_unique<ObstacleConstraints>(arms[i].space->robot());
  }
  return arms;
}

/// A free configuration of the arm and a goal for it.
void draw_task(const Robot& robot, Dice& dice, Arm& arm) {
  do arm.q = dice.configuration(robot);
  while (!arm.space->is_free(arm.q));
  arm.goal = dice.configuration(robot);
  arm.bodies = placed_bodies(arm.space->robot(), forward_kinematics(arm.space->robot(), arm.q));
}

/// Constraints against the map and the arm itself, at its place now.
void look(Arm& arm) {
  arm.control->look(arm.q);
  move_bodies(arm.space->robot(), arm.control->constraints().kinematics().map_from_link(),
              Eigen::VectorXd::Zero(6), arm.bodies);
}

/// Those against the bodies of the others, too.
void look_at_others(const std::vector<Arm>& arms, Arm& arm) {
  arm.constraints.clear();
  for (const Arm& other : arms) {
    if (&other != &arm)
      arm.near->append(arm.control->constraints().kinematics().map_from_link(), other.bodies, influence,
                       arm.constraints);
  }
  for (const ObstacleConstraint& constraint : arm.constraints)
    arm.control->add({constraint.gradient.data(), 6},
                     damper_bound(arm.control->options(), constraint.distance));
}

}  // namespace

nlohmann::ordered_json three_arms(const Snapshot& map, const Robot& robot) {
  std::vector<Arm> arms = arms_in_a_ring(map, robot);
  Dice dice(9);
  std::vector<double> times;
  double pairs = 0.0, others = 0.0;
  const double clock = clock_us();
  for (int start = 0; start < 60; ++start) {
    for (Arm& arm : arms) draw_task(robot, dice, arm);
    for (int i = 0; i < 20; ++i) {
      const double begin = now_us();
      for (Arm& arm : arms) look(arm);
      for (Arm& arm : arms) {
        look_at_others(arms, arm);
        pairs += static_cast<double>(arm.constraints.size());
        others += static_cast<double>(arm.control->constraints().constraints().size());
        arm.q += arm.control->solve(step_to_goal(arm.control->options(), arm.q, arm.goal));
      }
      times.push_back(now_us() - begin - clock);
    }
  }
  const auto count = static_cast<double>(times.size());
  return {{"median_us", median(times)},
          {"p99_us", quantile(times, 0.99)},
          {"rows_between_arms", pairs / count},
          {"other_rows", others / count}};
}

nlohmann::ordered_json against_exact(const ConfigurationSpace& space) {
  const Robot& robot = space.robot();
  ControlConstraints all(space, influence, 0.5 * (influence + security));
  Dice dice(7);
  int near = 0, farther = 0, farther_by_1_mm = 0;
  double worst = 0.0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Configuration q = dice.configuration(robot);
    std::vector<double> ours(robot.bodies.size(), influence), exact = ours;
    all.look(q);
    const auto note = [](std::vector<double>& least, int body, double distance) {
      double& known = least[static_cast<std::size_t>(body)];
      known = std::min(known, distance);
    };
    for (const ControlConstraint& constraint : all.constraints())
      note(ours, constraint.body, constraint.distance);
    for (const ProximityConstraint& constraint : space.proximity_constraints(q, influence))
      note(exact, constraint.body, constraint.distance);
    for (std::size_t body = 0; body < ours.size(); ++body) {
      if (exact[body] >= influence) continue;
      const double by = ours[body] - exact[body];
      ++near;
      farther += by > 1e-5;
      farther_by_1_mm += by > 1e-3;
      worst = std::max(worst, by);
    }
  }
  return {
      {"bodies", near}, {"farther", farther}, {"farther_by_1_mm", farther_by_1_mm}, {"farther_by_m", worst}};
}

nlohmann::ordered_json against_fcl(const Robot& robot) {
  const FclBodies bodies(robot);
  Dice dice(4);
  double ours = 0.0, theirs = 0.0, above = 0.0, below = 0.0;
  int compared = 0, fcl_above = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const LinkPoses one = forward_kinematics(robot, dice.configuration(robot));
    Robot other = robot;
    other.map_from_base.translation() = Eigen::Vector3d(0.7, 0.2, 0.0);
    const LinkPoses two = forward_kinematics(other, dice.configuration(robot));
    for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
      const std::size_t b = (a + static_cast<std::size_t>(trial)) % robot.bodies.size();
      const Eigen::Isometry3d pose_a = bodies.pose(robot, a, one), pose_b = bodies.pose(robot, b, two);
      DistanceBounds bounds;
      const double begin = now_us();
      bounds = distance(robot.bodies[a].shape, pose_a, robot.bodies[b].shape, pose_b);
      const double middle = now_us();
      const double first = fcl_distance(*bodies.shapes[a], pose_a, *bodies.shapes[b], pose_b).distance;
      const double end = now_us();
      if (first <= 0.0 || bounds.lower <= 0.0) continue;
      const double second =
          fcl_distance(*bodies.shapes[a], pose_a, *bodies.shapes[b], pose_b, fcl::GST_INDEP).distance;
      const double least = std::min(first, second);
      ++compared;
      ours += middle - begin;
      theirs += end - middle;
      above = std::max(above, bounds.lower - least);
      below = std::max(below, least - bounds.lower);
      fcl_above += first > bounds.upper + 1e-3;
    }
  }
  const double clock = clock_us() * compared;
  return {{"pairs", compared},
          {"ours_us", (ours - clock) / compared},
          {"fcl_us", (theirs - clock) / compared},
          {"ours_above_fcl_m", above},
          {"ours_below_fcl_m", below},
          {"fcl_too_large_by_1_mm", fcl_above}};
}

}  // namespace clearway::bench
