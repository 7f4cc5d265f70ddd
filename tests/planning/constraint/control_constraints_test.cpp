#include "planning/constraint/control_constraints.hpp"

#include <gtest/gtest.h>

#include <map>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace control_rows_test {

constexpr double edge = 0.03, influence = 0.12;

/// An arm among walls of voxels where its tip gets.
Snapshot cluttered(const Robot& robot, Random& random) {
  FreeSpaceMap map({.resolution = edge});
  for (int i = 0; i < 25; ++i) {
    const Eigen::Vector3d at = tip_pose(robot, random.configuration(robot)).translation();
    const Eigen::Vector3d u = random.point(1.0).normalized(), v = u.unitOrthogonal();
    for (int k = 0; k < 60; ++k) {
      const Eigen::Vector3d on = at + 0.15 * (2.0 * random.unit() - 1.0) * u + 0.15 * random.unit() * v;
      occupy(map, ((on / edge).array().floor() + 0.5) * edge);
    }
  }
  return map.snapshot();
}

/// Distance of a body from the nearest of all blocked cubes about it, one by one.
double true_distance(const ConfigurationSpace& space, int index, const LinkPoses& poses) {
  const Body& body = space.robot().bodies[static_cast<std::size_t>(index)];
  const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
  Eigen::AlignedBox3d box = body.shape.bounds(pose);
  box.min().array() -= influence + space.options().padding;
  box.max().array() += influence + space.options().padding;
  double least = influence;
  space.blocked_space(index)->visit_blocked(box, [&](const Eigen::Vector3d& cube) {
    const DistanceBounds bounds = distance_to_cube(body.shape, pose, cube, edge);
    least = std::min(least, bounds.upper - space.options().padding);
    return true;
  });
  return least;
}

Eigen::Vector3d middle(const Robot& robot, int index, const LinkPoses& poses) {
  const Body& body = robot.bodies[static_cast<std::size_t>(index)];
  return poses[static_cast<std::size_t>(body.link)] * body.link_from_shape *
         body.shape.bounds(Eigen::Isometry3d::Identity()).center();
}

class ControlConstraintsOf : public testing::TestWithParam<const char*> {};

TEST_P(ControlConstraintsOf, AreNoFartherThanTheirVoxelsAndHoldTheNearestOne) {
  const Robot robot = load_robot(GetParam());
  Random random(4);
  const ConfigurationSpace space(robot, cluttered(robot, random), {.critical_by_default = false},
                                 {.padding = 0.002});
  ControlConstraints constraints(space, influence, influence);
  int near = 0, farther = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    for (int body = 0; body < static_cast<int>(robot.bodies.size()); ++body) {
      // The first bodies turn about an axis through them: constraints that no joint changes are left out
      // there.
      if (robot.bodies[static_cast<std::size_t>(body)].link < 3) continue;
      double ours = influence;
      for (const ControlConstraint& constraint : constraints.constraints()) {
        if (constraint.body == body && constraint.other < 0) ours = std::min(ours, constraint.distance);
      }
      const double truth = true_distance(space, body, poses);
      EXPECT_GT(ours, truth - 0.01 * edge) << GetParam() << " body " << body;
      if (truth >= influence) continue;
      ++near;
      farther += ours > truth + 1e-5;
      EXPECT_LT(ours, truth + 0.5 * edge) << GetParam() << " body " << body;
    }
  }
  EXPECT_GT(near, 100);
  EXPECT_LE(farther, near / 20);
}

TEST_P(ControlConstraintsOf, EachConstraintIsTheRateOfApproachToAVoxelThatIsBlockedAndNotNearer) {
  const Robot robot = load_robot(GetParam());
  Random random(5);
  const ConfigurationSpace space(robot, cluttered(robot, random), {.critical_by_default = false});
  ControlConstraints constraints(space, influence, influence);
  int seen = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    for (std::size_t i = 0; i < constraints.constraints().size(); ++i) {
      const ControlConstraint& constraint = constraints.constraints()[i];
      const Body& body = robot.bodies[static_cast<std::size_t>(constraint.body)];
      Eigen::VectorXd expected =
          jacobian(robot, poses, body.link, constraint.point).topRows<3>().transpose() * constraint.normal;
      if (constraint.other < 0 && constraint.distance > 1e-3) {
        ++seen;
        // Beyond the gap there is a blocked voxel, and the body is behind its plane.
        const Eigen::Vector3d beyond = constraint.point + constraint.distance * constraint.normal;
        EXPECT_FALSE(space.blocked_space(constraint.body)
                         ->visit_blocked({beyond.array() - 5e-4, beyond.array() + 5e-4},
                                         [](const Eigen::Vector3d&) { return false; }));
        const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
        const Eigen::Vector3d farthest =
            pose * body.shape.support(pose.linear().transpose() * constraint.normal);
        EXPECT_LE(constraint.normal.dot(farthest - constraint.point), 1e-7);
      }
      if (constraint.other >= 0) {
        const Body& other = robot.bodies[static_cast<std::size_t>(constraint.other)];
        const DistanceBounds bounds =
            distance(body.shape, poses[static_cast<std::size_t>(body.link)] * body.link_from_shape,
                     other.shape, poses[static_cast<std::size_t>(other.link)] * other.link_from_shape);
        EXPECT_NEAR(constraint.distance, bounds.lower, 1e-6);
        const bool overlap = bounds.direction.squaredNorm() < 0.5;
        const Eigen::Vector3d on_other = overlap ? middle(robot, constraint.other, poses) : bounds.point_b;
        expected -= jacobian(robot, poses, other.link, on_other).topRows<3>().transpose() * constraint.normal;
      }
      for (std::size_t j = 0; j < robot.dof(); ++j)
        EXPECT_NEAR(constraints.gradient(i)[j], expected[static_cast<Eigen::Index>(j)], 2e-5);
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_P(ControlConstraintsOf, OfDampersHoldEveryVoxelThatAStepCanBringToItsBoundWithThePadding) {
  const Robot robot = load_robot(GetParam());
  Random random(9);
  const double padding = 0.06;
  const ConfigurationSpace space(robot, cluttered(robot, random), {.critical_by_default = false},
                                 {.padding = padding});
  const auto joints = static_cast<Eigen::Index>(robot.dof());
  const DamperOptions damper{0.01, 0.12, 0.02, 0.05, Eigen::VectorXd::Ones(joints)};
  ControlConstraints constraints(space, damper);
  int can_bind = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    for (int index = 0; index < static_cast<int>(robot.bodies.size()); ++index) {
      if (space.blocked_space(index) == nullptr) continue;
      const Body& body = robot.bodies[static_cast<std::size_t>(index)];
      const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
      Eigen::AlignedBox3d box = body.shape.bounds(pose);
      box.min().array() -= influence + padding;
      box.max().array() += influence + padding;
      DistanceBounds nearest;
      nearest.upper = 1.0;
      space.blocked_space(index)->visit_blocked(box, [&](const Eigen::Vector3d& cube) {
        const DistanceBounds bounds = distance_to_cube(body.shape, pose, cube, edge);
        if (bounds.upper < nearest.upper) nearest = bounds;
        return true;
      });
      if (nearest.upper >= 1.0 || nearest.lower <= 0.0) continue;
      // Half a voxel more, since the constraint may be of a neighbour; and still its damper binds in one
      // step.
      const double distance = nearest.upper - padding + 0.5 * edge;
      const Eigen::VectorXd rates =
          jacobian(robot, poses, body.link, nearest.point_a).topRows<3>().transpose() * nearest.direction;
      const double approach = damper.max_step * rates.cwiseAbs().sum();
      if (distance >= damper.influence_distance || approach <= std::max(1e-6, damper_bound(damper, distance)))
        continue;
      ++can_bind;
      double ours = 1.0;
      for (const ControlConstraint& constraint : constraints.constraints()) {
        if (constraint.body == index && constraint.other < 0) ours = std::min(ours, constraint.distance);
      }
      EXPECT_LE(ours, distance) << GetParam() << " body " << index;
    }
  }
  EXPECT_GT(can_bind, 50);
}

TEST_P(ControlConstraintsOf, OfDampersHoldNothingThatNoStepCanBringToItsBound) {
  const Robot robot = load_robot(GetParam());
  Random random(10);
  const ConfigurationSpace space(robot, cluttered(robot, random), {.critical_by_default = false});
  const DamperOptions damper{0.005, 0.12, 0.02, 0.05,
                             Eigen::VectorXd::Ones(static_cast<Eigen::Index>(robot.dof()))};
  const double per_move = (damper.influence_distance - damper.security_distance) / damper.xi;
  ControlConstraints constraints(space, damper),
      all(space, damper.influence_distance, damper.influence_distance);
  std::size_t kept = 0, left_out = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    all.look(q);
    for (const ControlConstraint& constraint : constraints.constraints()) {
      if (constraint.other >= 0) continue;
      // The body lies in the sphere about its box: no point of it moves farther than this.
      const Body& body = robot.bodies[static_cast<std::size_t>(constraint.body)];
      const double radius = 0.5 * body.shape.bounds(Eigen::Isometry3d::Identity()).diagonal().norm();
      const Eigen::MatrixXd columns =
          jacobian(robot, poses, body.link, middle(robot, constraint.body, poses));
      const double move = damper.max_step * (columns.topRows<3>().colwise().norm().sum() +
                                             radius * columns.bottomRows<3>().colwise().norm().sum());
      EXPECT_LE(constraint.distance, damper.security_distance + per_move * move + 1e-6)
          << robot.name << constraint.body;
      ++kept;
    }
    left_out +=
        all.constraints().size() - std::min(constraints.constraints().size(), all.constraints().size());
  }
  EXPECT_GT(kept, 50U);
  EXPECT_GT(left_out, 50U);
}

INSTANTIATE_TEST_SUITE_P(Arms, ControlConstraintsOf, testing::Values("puma560", "panda", "arm5"));

TEST(ControlConstraints, BodiesThatOverlapHaveAConstraintAlongTheLineBetweenTheirMiddles) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = edge}).snapshot());
  ControlConstraints constraints(space, influence, influence);
  Random random(6);
  int seen = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    for (const ControlConstraint& constraint : constraints.constraints()) {
      if (constraint.other < 0 || constraint.distance > 0.0) continue;
      const Body& body = robot.bodies[static_cast<std::size_t>(constraint.body)];
      const Body& other = robot.bodies[static_cast<std::size_t>(constraint.other)];
      const DistanceBounds bounds =
          distance(body.shape, poses[static_cast<std::size_t>(body.link)] * body.link_from_shape, other.shape,
                   poses[static_cast<std::size_t>(other.link)] * other.link_from_shape, influence);
      if (bounds.direction.squaredNorm() > 0.5) continue;
      ++seen;
      const Eigen::Vector3d apart =
          middle(robot, constraint.other, poses) - middle(robot, constraint.body, poses);
      EXPECT_NEAR(constraint.normal.dot(apart), apart.norm(), 1e-9) << trial;
    }
  }
  EXPECT_GT(seen, 0);
}

TEST(ControlConstraints, OfADampersStepLookNoFartherThanTheStepAndItsDamperReach) {
  Robot robot = load_robot("point");
  robot.map_from_base.translation().z() = 0.025;
  FreeSpaceMap map({.resolution = 0.05});
  for (int y = -20; y < 20; ++y) occupy(map, {0.525, (y + 0.5) * 0.05, 0.025});  // a wall at x = 0.5
  const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false});
  const DamperOptions damper{0.02, 0.3, 0.07, 0.115, Eigen::VectorXd::Ones(2)};
  // The disc's radius is 0.2 m, a step at most 0.02 m an axis: from 0.07 + 2 * 0.04 m on it cannot bind.
  ControlConstraints constraints(space, damper);
  constraints.look(Eigen::Vector2d(0.1, 0.0));  // 0.2 m away
  EXPECT_TRUE(constraints.constraints().empty());
  constraints.look(Eigen::Vector2d(0.2, 0.0));  // 0.1 m away
  EXPECT_FALSE(constraints.constraints().empty());
}

TEST(ControlConstraints, ADiscInOneLayerOfKnownSpaceSeesItsWallsAndNotItsFloor) {
  Robot robot = load_robot("point");
  robot.map_from_base.translation().z() = 0.025;
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("floor", {"base"});
  for (int x = -10; x < 10; ++x) {
    for (int y = -10; y < 10; ++y)
      map.paint(volume, {(Eigen::Vector3d(x, y, 0).array() + 0.5) * 0.05, 0.87 * 0.05});
  }
  const ConfigurationSpace space(robot, map.snapshot());
  ControlConstraints constraints(space, 0.2, 0.2);
  constraints.look(Eigen::Vector2d(0.0, 0.0));
  EXPECT_TRUE(constraints.constraints().empty());  // walls are 0.3 m away
  constraints.look(Eigen::Vector2d(0.2, 0.0));
  double toward_wall = 1.0;
  for (std::size_t i = 0; i < constraints.constraints().size(); ++i) {
    if (constraints.gradient(i)[0] > 0.99)
      toward_wall = std::min(toward_wall, constraints.constraints()[i].distance);
  }
  EXPECT_NEAR(toward_wall, 0.1, 1e-3);
}

/// Where the wall is farther than halfway between d_s and d_i, its voxel nearest to the disc alone counts.
TEST(ControlConstraints, OfADampersStepLookRoundFromHalfwayToWhereItStopsOn) {
  Robot robot = load_robot("point");
  robot.map_from_base.translation().z() = 0.025;
  FreeSpaceMap map({.resolution = 0.05});
  for (int y = -20; y < 20; ++y) occupy(map, {0.525, (y + 0.5) * 0.05, 0.025});  // a wall at x = 0.5
  const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false},
                                 {.max_distance = 1.0});
  const DamperOptions damper{0.2, 0.3, 0.1, 0.2, Eigen::VectorXd::Ones(2)};
  ControlConstraints constraints(space, damper);
  for (const double away : {0.29, 0.25, 0.21, 0.19, 0.15, 0.11}) {
    constraints.look(Eigen::Vector2d(0.3 - away, 0.013));
    EXPECT_EQ(constraints.constraints().size() > 1, away < 0.2) << away;
    EXPECT_FALSE(constraints.constraints().empty()) << away;
  }
}

/// The same without a damper, where distances are less by the padding.
TEST(ControlConstraints, LookRoundBelowTheCloseDistanceOfThePaddedBody) {
  Robot robot = load_robot("point");
  robot.map_from_base.translation().z() = 0.025;
  FreeSpaceMap map({.resolution = 0.05});
  for (int y = -20; y < 20; ++y) occupy(map, {0.525, (y + 0.5) * 0.05, 0.025});  // a wall at x = 0.5
  const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false},
                                 {.padding = 0.04, .max_distance = 1.0});
  ControlConstraints constraints(space, 0.3, 0.2);
  for (const double away : {0.31, 0.29, 0.25, 0.21, 0.19, 0.15, 0.11}) {
    constraints.look(Eigen::Vector2d(0.3 - 0.04 - away, 0.013));
    EXPECT_EQ(constraints.constraints().size() > 1, away < 0.2) << away;
    EXPECT_EQ(constraints.constraints().empty(), away > 0.3) << away;
    for (const ControlConstraint& constraint : constraints.constraints())
      EXPECT_GE(constraint.distance, away - 1e-3);
  }
}

/// Each body by the policy of its own part: what blocks one is nothing to another.
TEST(ControlConstraints, OfBodiesUnderSeveralPoliciesAreOfWhatBlocksEach) {
  const Robot robot = load_robot("puma560");
  Random random(12);
  FreeSpaceMap map({.resolution = edge});
  const int volume = map.add_volume("free", {});
  for (int i = 0; i < 25; ++i)
    map.paint(volume, {tip_pose(robot, random.configuration(robot)).translation(), 0.3});
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d at = tip_pose(robot, random.configuration(robot)).translation() + random.point(0.1);
    occupy(map, ((at / edge).array().floor() + 0.5) * edge);
  }
  Policies policies{.other = Policy::not_occupied, .critical_by_default = false};
  const int last = static_cast<int>(robot.bodies.size()) - 1;
  policies.parts[robot.bodies[static_cast<std::size_t>(last)].part] = Policy::painted;
  policies.parts[robot.bodies[static_cast<std::size_t>(last) - 1].part] = Policy::known_free;
  const ConfigurationSpace space(robot, map.snapshot(), policies);
  ControlConstraints constraints(space, influence, influence);
  std::map<Policy, int> near;
  int farther = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    constraints.look(q);
    for (int body = 0; body <= last; ++body) {
      if (robot.bodies[static_cast<std::size_t>(body)].link < 3) continue;
      double ours = influence;
      for (const ControlConstraint& constraint : constraints.constraints())
        if (constraint.body == body && constraint.other < 0) ours = std::min(ours, constraint.distance);
      const double truth = std::max(0.0, true_distance(space, body, poses));
      EXPECT_GT(ours, truth - 0.01 * edge) << body;
      farther += ours > truth + 0.5 * edge;  // of a voxel that no joint moves the body towards or from
      near[space.policies().at(robot.bodies[static_cast<std::size_t>(body)].part)] +=
          truth > 0.0 && truth < influence;
    }
  }
  EXPECT_LE(farther, 3);
  for (const Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied})
    EXPECT_GT(near[policy], 5);
}

}  // namespace control_rows_test
}  // namespace clearway
