#include "planning/constraint/local_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace local_step_test {

DamperOptions example() { return {0.1, 0.5, 0.1, 0.2, Eigen::Vector2d::Ones()}; }

TEST(DamperBound, FallsFromXiAtTheInfluenceDistanceToZeroAtTheSecurityDistance) {
  const DamperOptions options = example();
  EXPECT_NEAR(damper_bound(options, 0.5), 0.2, 1e-15);
  EXPECT_NEAR(damper_bound(options, 0.3), 0.1, 1e-15);
  EXPECT_NEAR(damper_bound(options, 0.1), 0.0, 1e-15);
  EXPECT_NEAR(damper_bound(options, 0.0), -0.05, 1e-15);  // separation demanded
}

TEST(DamperBound, OneStepNeverCrossesTheSecurityDistance) {
  DamperOptions options = example();
  options.xi = options.influence_distance - options.security_distance;  // the largest allowed
  for (double d = 0.1; d <= 0.5; d += 0.01)
    EXPECT_GE(d - damper_bound(options, d), options.security_distance - 1e-12);
}

TEST(StepToGoal, PointsAtTheGoalAndIsAtMostOneStepLong) {
  const DamperOptions options = example();
  const Eigen::Vector2d q(0.2, 0.3);
  EXPECT_NEAR((step_to_goal(options, q, Eigen::Vector2d(3.2, 4.3)) - 0.1 * Eigen::Vector2d(0.6, 0.8)).norm(),
              0.0, 1e-15);
  EXPECT_EQ(step_to_goal(options, q, Eigen::Vector2d(0.25, 0.3)), Eigen::Vector2d(0.25, 0.3) - q);
  EXPECT_EQ(step_to_goal(options, q, q), Eigen::Vector2d::Zero());
}

TEST(LocalStep, SlidesAlongAWallAndKeepsTheBox) {
  StepConstraints constraints;
  constraints.matrix = Eigen::RowVector2d(1.0, 0.0);
  constraints.bounds = Eigen::VectorXd::Constant(1, 0.01);
  constraints.lower = Eigen::Vector2d(-1.0, -1.0), constraints.upper = Eigen::Vector2d(1.0, 0.02);
  const LocalStep step = local_step(constraints, Eigen::Vector2d(0.08, 0.06), example());
  EXPECT_NEAR((step.step - Eigen::Vector2d(0.01, 0.02)).norm(), 0.0, 1e-12);
  EXPECT_GT(step.multipliers[0], 0.0);
  EXPECT_GT(step.multipliers[2], 0.0);  // upper limit of the second joint
  EXPECT_EQ(step.demand, 1.0);
}

Policies anywhere_but_occupied() {
  Policies policies;
  policies.critical_by_default = false;
  return policies;
}

TEST(ConstraintsAt, AreTheConstraintsOfTheSpaceAndTheRoomToTheLimits) {
  VoxelScene scene;
  scene.occupied = {box_of(0.3, -0.2, -0.1, 0.4, 0.2, 0.1)};
  Robot robot = load_robot("point");
  robot.joints[0].lower = -0.01, robot.joints[0].upper = 0.5;
  const ConfigurationSpace space(robot, scene.snapshot(), anywhere_but_occupied());
  DamperOptions options = example();
  options.weight = Eigen::Vector2d(2.0, 2.0);
  const Eigen::Vector2d q(0.0, 0.0);
  const StepConstraints constraints = constraints_at(space, q, options);
  const auto pairs = space.proximity_constraints(q, options.influence_distance);
  ASSERT_EQ(constraints.pairs.size(), pairs.size());
  ASSERT_FALSE(pairs.empty());
  double nearest = 1.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_EQ(constraints.matrix.row(row), 0.5 * pairs[i].gradient.transpose());
    EXPECT_EQ(constraints.bounds[row], damper_bound(options, pairs[i].distance));
    nearest = std::min(nearest, pairs[i].distance);
  }
  EXPECT_EQ(constraints.separation, nearest);
  EXPECT_NEAR(constraints.separation, 0.1, 1e-6);  // the disc's radius is 0.2
  EXPECT_NEAR(constraints.lower[0], -0.02, 1e-12);
  EXPECT_NEAR(constraints.upper[0], 1.0, 1e-12);
}

TEST(LocalStep, FirstOrderApproachIsKeptBelowTheDamper) {
  // Random places of an arm among blocks: the real change of distance follows the bound to first order.
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  VoxelScene scene;
  scene.occupied = {box_of(0.8, 0.3, -0.1, 1.0, 0.5, 0.1), box_of(-0.5, -1.2, -0.1, -0.2, -0.9, 0.1)};
  const ConfigurationSpace space(load_robot("planar2"), scene.snapshot(), anywhere_but_occupied());
  const DamperOptions options = {0.002, 0.3, 0.05, 0.002, Eigen::Vector2d::Ones()};
  int near = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d q(3.0 * uniform(random), 2.5 * uniform(random));
    if (!space.is_free(q)) continue;
    const StepConstraints constraints = constraints_at(space, q, options);
    if (constraints.pairs.empty()) continue;
    ++near;
    const Eigen::Vector2d wanted = 0.002 * Eigen::Vector2d(uniform(random), uniform(random)).normalized();
    const LocalStep step = local_step(constraints, wanted, options);
    const double after = constraints_at(space, q + step.step, options).separation;
    const double bound = damper_bound(options, constraints.separation);
    EXPECT_GE(after, constraints.separation - std::max(bound, 0.0) - 2e-5) << q.transpose();
  }
  EXPECT_GT(near, 50);
}

TEST(Resolve, DefaultsScaleWithTheRobotAndTheMap) {
  const Robot full = load_robot("puma560"), miniature = scaled(full, 0.1);
  const Eigen::VectorXd q = (Eigen::VectorXd(6) << 0.0, -0.8, 0.3, 0.0, 0.4, 0.0).finished();
  VoxelScene coarse, fine;
  coarse.resolution = 0.02, fine.resolution = 0.002;
  const ConfigurationSpace big(full, coarse.snapshot(), anywhere_but_occupied());
  const ConfigurationSpace small(miniature, fine.snapshot(), anywhere_but_occupied());
  const PathCost cost(full);
  const DamperOptions a = resolve({}, {big, cost, q, q}), b = resolve({}, {small, cost, q, q});
  EXPECT_NEAR(b.influence_distance, 0.1 * a.influence_distance, 1e-9);
  EXPECT_NEAR(b.security_distance, 0.1 * a.security_distance, 1e-6);
  EXPECT_NEAR(b.max_step, a.max_step, 1e-3 * a.max_step);
  EXPECT_LT(a.max_step, 0.05);
  EXPECT_GT(a.max_step, 0.005);
}

TEST(Resolve, RefusesASpeedThatCouldCrossTheSecurityDistance) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{}.snapshot(), anywhere_but_occupied());
  const PathCost cost(space.robot());
  const Eigen::Vector2d q(0.0, 0.0);
  ConstraintOptions options;
  options.influence_distance = 0.2, options.security_distance = 0.1, options.xi = 0.11;
  EXPECT_THROW(resolve(options, {space, cost, q, q}), std::invalid_argument);
  options.xi = 0.1;
  EXPECT_NO_THROW(resolve(options, {space, cost, q, q}));
  options.security_distance = 0.3;
  EXPECT_THROW(resolve(options, {space, cost, q, q}), std::invalid_argument);
}

}  // namespace local_step_test
}  // namespace clearway
