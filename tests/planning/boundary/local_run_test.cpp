#include "planning/boundary/local_run.hpp"

#include <gtest/gtest.h>

#include "planning/boundary/boundary_plus_search.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace local_run_test {

using Eigen::Vector2d;

/// The point robot (a disc of 0.2 m) before a wall across its way.
struct Wall {
  Robot robot = load_robot("point");
  ConfigurationSpace space;
  PathCost cost;
  PlanProblem leg;
  DamperOptions damper;
  mutable ControlConstraints constraints;  ///< only memory that is kept
  DeadlockMemory memory;

  explicit Wall(std::vector<Eigen::AlignedBox3d> boxes = {box_of(1, -0.8, -0.05, 1.1, 0.8, 0.05)})
      : space(robot, VoxelScene{0.05, std::move(boxes), {}, {}}.snapshot(),
              {.parts = {}, .critical_by_default = false}),
        cost(robot),
        leg{space, cost, Vector2d(0.0, 0.0), Vector2d(2.5, 0.0)},
        damper(resolve({}, leg)),
        constraints(constraints_for(space, damper)),
        memory(damper.weight, 2.0 * damper.max_step) {}

  void expect_certified(const std::vector<Configuration>& trace) const {
    for (std::size_t i = 1; i < trace.size(); ++i)
      ASSERT_TRUE(space.is_edge_free(trace[i - 1], trace[i])) << i;
  }
};

TEST(LocalRun, GoesStraightToAGoalThatItSees) {
  const Wall scene({box_of(1, 2, -0.05, 1.1, 3, 0.05)});
  const LocalRun run = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 100);
  EXPECT_EQ(run.end, RunEnd::reached);
  EXPECT_EQ(run.trace, (std::vector<Configuration>{scene.leg.start, scene.leg.goal}));
}

TEST(LocalRun, IsStuckBeforeAWallAndAPlaneLeadsRoundIt) {
  const Wall scene;
  const LocalRun stuck = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 1000);
  EXPECT_EQ(stuck.end, RunEnd::deadlock);
  EXPECT_LT(stuck.trace.back()[0], 0.8);
  EXPECT_GT(stuck.trace.back()[0], 0.6);
  for (const double side : {1.0, -1.0}) {
    const PlanProblem on{scene.space, scene.cost, stuck.trace.back(), scene.leg.goal};
    const LocalRun round = run_local(on, scene.damper, scene.constraints, scene.memory, 1000,
                                     Eigen::VectorXd(Vector2d(0.0, side)));
    EXPECT_EQ(round.end, RunEnd::reached);
    EXPECT_GT(round.boundary_steps, 10);
    scene.expect_certified(round.trace);
    double farthest = 0.0;
    for (const Configuration& q : round.trace) farthest = std::max(farthest, side * q[1]);
    EXPECT_GT(farthest, 0.8);
  }
}

TEST(LocalRun, DoesNotGoBackWhereItWasStuck) {
  Wall scene;
  const LocalRun stuck = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 1000);
  scene.memory.remember(stuck.trace.back());
  const LocalRun again = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 1000);
  EXPECT_EQ(again.end, RunEnd::known_deadlock);
  EXPECT_LT(again.trace.size(), stuck.trace.size());
}

TEST(LocalRun, KeepsItsStepsAndTheDeadline) {
  Wall scene;
  const LocalRun few = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 5);
  EXPECT_EQ(few.end, RunEnd::used_up);
  EXPECT_EQ(few.trace.size(), 6u);
  int asked = 0;
  scene.leg.out_of_time = [&] { return ++asked > 3; };
  const LocalRun late = run_local(scene.leg, scene.damper, scene.constraints, scene.memory, 1000);
  EXPECT_EQ(late.end, RunEnd::out_of_time);
  EXPECT_EQ(late.trace.size(), 4u);
}

TEST(PlaneDirection, LeadsTheBlockingPointOverAndUnderAndTowardsTheLimits) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(
      robot, VoxelScene{0.05, {box_of(0.5, -0.4, 0.2, 0.55, 0.4, 0.9)}, {}, {}}.snapshot(),
      {.parts = {}, .critical_by_default = false});
  const PathCost cost(robot);
  Configuration start(5), goal(5);
  start << 0.0, -1.9, 2.3, 0.0, 0.0;
  goal << 0.0, 0.0, 0.0, 0.0, 0.0;
  const PlanProblem leg{space, cost, start, goal};
  const DamperOptions damper = resolve({}, leg);
  ControlConstraints constraints = constraints_for(space, damper);
  const LocalRun stuck = run_local(leg, damper, constraints, DeadlockMemory(damper.weight, 0.1), 1000);
  ASSERT_EQ(stuck.end, RunEnd::deadlock);
  const Configuration& lock = stuck.trace.back();
  std::mt19937_64 random(1);
  const auto along = [&](int plane) { return plane_direction(plane, space, damper, lock, stuck, random); };
  // The point that blocks most rises in plane 0 and sinks in plane 1: its velocity by differences.
  Eigen::Index strongest = 0;
  stuck.local.multipliers.head(static_cast<Eigen::Index>(stuck.constraints.pairs.size()))
      .maxCoeff(&strongest);
  const ProximityConstraint& pair = stuck.constraints.pairs[static_cast<std::size_t>(strongest)];
  const int link = robot.bodies[static_cast<std::size_t>(pair.body)].link;
  const auto rise = [&](const Eigen::VectorXd& dq) {
    const auto pose = [&](const Configuration& q) {
      return forward_kinematics(robot, q)[static_cast<std::size_t>(link)];
    };
    return (pose(lock + 1e-6 * dq) * (pose(lock).inverse() * pair.point) - pair.point).z();
  };
  EXPECT_GT(rise(along(0)), 0.0);
  EXPECT_LT(rise(along(1)), 0.0);
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    EXPECT_NEAR(along(4)[i], robot.joints[j].upper - lock[i], 1e-12);
    EXPECT_NEAR(along(5)[i], robot.joints[j].lower - lock[i], 1e-12);
  }
  EXPECT_NE(along(6), along(6));  // drawn
}

}  // namespace local_run_test
}  // namespace clearway
