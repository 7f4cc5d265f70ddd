#include <array>
#include <cmath>
#include <numbers>

#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_teams.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace {

constexpr std::array<const char*, 3> arms = {"arm5", "puma560", "panda"};
constexpr double between_robots = 0.08;    ///< m, at starts and goals
constexpr double before_obstacles = 0.30;  ///< m, at starts
constexpr int most_crossing_draws = 20000;

Eigen::Vector3d direction(SuiteDice& dice) {
  const double z = dice.between(-1.0, 1.0), angle = dice.between(0.0, 2.0 * std::numbers::pi);
  const double flat = std::sqrt(1.0 - z * z);
  return {flat * std::cos(angle), flat * std::sin(angle), z};
}

Eigen::Isometry3d pose_at(const Eigen::Vector3d& place, SuiteDice& dice) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  const Eigen::Vector3d axis = direction(dice);
  pose.linear() = Eigen::AngleAxisd(dice.between(0.0, 2.0), axis).toRotationMatrix();
  return pose;
}

/// From a place outside the ring through a place in it to the other side, and back.
SuiteMoving draw_moving(int number, double ring, SuiteDice& dice) {
  SuiteMoving moving;
  moving.shape.name = "obstacle" + std::to_string(number);
  switch (dice.whole(0, 2)) {
    case 0:
      moving.shape.geometry = SphereShape{dice.between(0.05, 0.15)};
      break;
    case 1: {
      const double x = dice.between(0.08, 0.3), y = dice.between(0.08, 0.3), z = dice.between(0.08, 0.3);
      moving.shape.geometry = BoxShape{{x, y, z}};
      break;
    }
    default: {
      const double radius = dice.between(0.04, 0.1), length = dice.between(0.1, 0.4);
      moving.shape.geometry = CylinderShape{radius, length};
    }
  }
  const double off = ring * dice.between(0.0, 0.8);
  Eigen::Vector3d middle = off * direction(dice);
  middle.z() = dice.between(0.3, 1.2);
  const Eigen::Vector3d way = (ring + 1.5) * direction(dice).cwiseProduct(Eigen::Vector3d(1.0, 1.0, 0.3));
  const double leg = 2.0 * way.norm() / dice.between(0.05, 0.4);
  moving.path.push_back({0.0, pose_at(middle - way, dice)});
  moving.path.push_back({leg, pose_at(middle + way, dice)});
  moving.path.push_back({2.0 * leg, moving.path.front().map_from_shape});
  moving.repeats = true;
  return moving;
}

Configuration draw_within_limits(const Robot& robot, SuiteDice& dice) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    q[j] = dice.between(joint.lower, joint.upper);
  }
  return q;
}

bool is_apart(const Robot& robot, const Configuration& q, const std::vector<PlacedShape>& others,
              double margin) {
  std::vector<ObstacleConstraint> constraints;
  return ObstacleConstraints(robot).append(forward_kinematics(robot, q), others, margin, constraints) >=
             margin &&
         constraints.empty();
}

/// The bodies of all robots but one that no joint moves.
std::vector<PlacedShape> standing_bodies(const Team& team, std::size_t but) {
  std::vector<PlacedShape> all;
  for (std::size_t i = 0; i < team.robots.size(); ++i) {
    const Robot& robot = team.robots[i].space->robot();
    if (i == but) continue;
    const std::vector<PlacedShape> bodies =
        placed_bodies(robot, forward_kinematics(robot, team.robots[i].start));
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (!is_moved(robot, robot.bodies[b].link)) all.push_back(bodies[b]);
  }
  return all;
}

/// A configuration of robot `i` that is free by itself and away from the others that stand already, its
/// bodies then among these; nothing after many draws.
std::vector<double> draw_end(const Team& team, std::size_t i, std::vector<PlacedShape>& others,
                             const std::vector<PlacedShape>& obstacles, SuiteDice& dice) {
  const ConfigurationSpace& space = *team.robots[i].space;
  const Robot& robot = space.robot();
  const std::vector<PlacedShape> standing = standing_bodies(team, i);
  for (int draw = 0; draw < most_crossing_draws; ++draw) {
    const Configuration q = draw_within_limits(robot, dice);
    if (!is_apart(robot, q, others, between_robots) || !is_apart(robot, q, standing, between_robots) ||
        !is_apart(robot, q, obstacles, before_obstacles) || !space.is_free(q))
      continue;
    const std::vector<PlacedShape> bodies = placed_bodies(robot, forward_kinematics(robot, q));
    others.insert(others.end(), bodies.begin(), bodies.end());
    return {q.begin(), q.end()};
  }
  return {};
}

/// Arms in a ring, without starts and goals.
SuiteTeam draw_ring(double& ring, SuiteDice& dice) {
  SuiteTeam team;
  const int robots = dice.whole(2, 5);
  ring = dice.between(0.8, 1.4) / (2.0 * std::sin(std::numbers::pi / robots));
  for (int i = 0; i < robots; ++i) {
    SuiteTeamRobot& robot = team.robots.emplace_back();
    robot.name = "robot" + std::to_string(i + 1);
    robot.robot = arms[static_cast<std::size_t>(dice.whole(0, 2))];
    const double angle = 2.0 * std::numbers::pi * i / robots;
    Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
    base.translation() = ring * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    base.linear() =
        Eigen::AngleAxisd(angle + std::numbers::pi + dice.between(-0.5, 0.5), Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    robot.map_from_base = base;
  }
  const int obstacles = dice.whole(0, 3);
  for (int i = 0; i < obstacles; ++i) team.moving.push_back(draw_moving(i + 1, ring, dice));
  return team;
}

}  // namespace

SuiteTeam draw_crossing(const SuiteGenerator& generator, std::size_t index) {
  SuiteDice dice(generator.seed, index);
  const Snapshot nothing = empty_map();
  for (;;) {
    double ring = 0.0;
    SuiteTeam team = draw_ring(ring, dice);
    for (SuiteTeamRobot& robot : team.robots) {  // any values, so that the team can be made
      robot.start = robot.goal = std::vector<double>(load_robot(robot.robot).dof(), 0.0);
    }
    const Team made = make_team(team, nothing, {});
    std::vector<PlacedShape> at_start, at_goal, obstacles;
    for (const MovingObstacle& obstacle : made.obstacles) obstacles.push_back(obstacle.placed(0.0, 0.02));
    bool is_drawn = true;
    for (std::size_t i = 0; i < team.robots.size() && is_drawn; ++i) {
      team.robots[i].start = draw_end(made, i, at_start, obstacles, dice);
      team.robots[i].goal = draw_end(made, i, at_goal, {}, dice);
      is_drawn = !team.robots[i].start.empty() && !team.robots[i].goal.empty();
    }
    if (!is_drawn) continue;
    team.name = "crossing" + std::to_string(index + 1);
    return team;
  }
}

}  // namespace clearway
