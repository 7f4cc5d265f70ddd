#include "planning/boundary/certified_motion.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace certified_motion_test {

using Eigen::Vector2d;

/// A disc of 0.2 m before a wall at x = 1.
class Motion : public testing::Test {
 protected:
  static Policies policies() {
    Policies chosen;
    chosen.critical_by_default = false;
    return chosen;
  }
  static Robot robot() {
    Robot disc = load_robot("point");
    disc.joints[1].upper = 0.5;
    return disc;
  }
  ConfigurationSpace space{robot(), VoxelScene{0.05, {box_of(1, -1, -0.05, 1.1, 1, 0.05)}, {}, {}}.snapshot(),
                           policies()};
  PathCost cost{space.robot()};
  PlanProblem problem{space, cost, Vector2d(0.0, 0.0), Vector2d(0.5, 0.1)};
  DamperOptions options{0.1, 0.2, 0.02, 0.09, Vector2d::Ones()};
};

TEST_F(Motion, TakesCertifiedStepsAndKeepsTheTrace) {
  CertifiedMotion motion(problem, options);
  EXPECT_TRUE(motion.take(Vector2d(0.1, 0.0)));
  EXPECT_EQ(motion.position(), Vector2d(0.1, 0.0));
  EXPECT_NEAR(motion.distance_to_goal(), Vector2d(0.4, 0.1).norm(), 1e-15);
  EXPECT_EQ(motion.steps(), 1);
  EXPECT_FALSE(motion.take(Vector2d::Zero()));
}

TEST_F(Motion, HalvesAStepThatIsNotFree) {
  CertifiedMotion motion(problem, options);
  EXPECT_TRUE(motion.take(Vector2d(1.0, 0.0)));  // the wall stops the disc at x = 0.8
  EXPECT_EQ(motion.position(), Vector2d(0.5, 0.0));
  EXPECT_EQ(motion.result({}, PlanStatus::no_path, "").statistics.at("steps_shortened"), 1.0);
  while (motion.position()[0] < 0.8 - 1e-9 && motion.take(Vector2d(0.4, 0.0))) {
  }
  EXPECT_LT(motion.position()[0], 0.8);
  EXPECT_GT(motion.position()[0], 0.79);
}

TEST_F(Motion, EndsExactlyAtTheGoalAndAtLimits) {
  CertifiedMotion motion(problem, options);
  EXPECT_TRUE(motion.take(Vector2d(0.5, 0.1 + 1e-12)));
  EXPECT_TRUE(motion.is_at_goal());
  EXPECT_EQ(motion.position(), problem.goal);
  const PlanResult result = motion.result({}, PlanStatus::no_path, "there");
  EXPECT_EQ(result.status, PlanStatus::solved);
  EXPECT_EQ(result.waypoints.size(), 2u);
  EXPECT_NEAR(result.cost, cost(result.waypoints), 1e-12);
  EXPECT_TRUE(motion.take(Vector2d(0.0, 0.9)));
  EXPECT_EQ(motion.position()[1], 0.5);
}

TEST_F(Motion, WeightsScaleSteps) {
  options.weight = Vector2d(2.0, 2.0);
  CertifiedMotion motion(problem, options);
  EXPECT_TRUE(motion.take(Vector2d(0.2, 0.0)));
  EXPECT_EQ(motion.position(), Vector2d(0.1, 0.0));
  EXPECT_NEAR(motion.weighted_position()[0], 0.2, 1e-15);
}

TEST_F(Motion, SaysWhatHoldsItBack) {
  const StepConstraints near = constraints_at(space, Vector2d(0.75, 0.0), options);
  const LocalStep step = local_step(near, Vector2d(0.1, 0.0), options);
  EXPECT_EQ(holding_back(space, near, step.multipliers).substr(0, 40),
            "base is 50.0 mm from what blocks it near");
  const StepConstraints limit = constraints_at(space, Vector2d(0.0, 0.5), options);
  EXPECT_EQ(holding_back(space, limit, local_step(limit, Vector2d(0.0, 0.1), options).multipliers),
            "joint y is at its limit");
  EXPECT_EQ(holding_back(space, limit, local_step(limit, Vector2d(0.0, -0.1), options).multipliers),
            "no constraint holds it back");
}

TEST(CreepWatch, SeesCreepingAndRockingButNotSteadyGain) {
  CreepWatch steady(0.1), creeping(0.1), rocking(0.1);
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(steady.is_creeping(10.0 - 0.001 * i));
    EXPECT_EQ(creeping.is_creeping(10.0 - 0.00001 * i), i >= 10);
    EXPECT_EQ(rocking.is_creeping(10.0 + (i % 2 == 0 ? 0.0 : 0.05)), i >= 10);
  }
  rocking.restart();
  EXPECT_FALSE(rocking.is_creeping(10.0));
}

}  // namespace certified_motion_test
}  // namespace clearway
