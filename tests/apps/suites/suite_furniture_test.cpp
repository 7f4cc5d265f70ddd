#include "apps/suites/suite_furniture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "apps/suites/suite_hand.hpp"
#include "apps/suites/suite_reaching.hpp"
#include "mapping/files/map_digest.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_furniture_test {

constexpr std::size_t kinds = 7;
const Policies open{.parts = {}, .critical_by_default = false};

SuiteGenerator generator(int count) {
  return {.kind = "cells", .count = count, .seed = 1, .resolution = 0.02};
}

/// Whether the hand at q is at one of the places: its end there or before it, pointing as it should.
bool is_grasp(const FurnitureScene& scene, const Robot& robot, const Configuration& q,
              const HandAtTip& hand = {}) {
  const Eigen::Isometry3d tip = tip_pose(robot, q);
  const Eigen::Vector3d ahead = tip.linear() * hand.axis;
  for (const GraspPlace& place : scene.places) {
    const Eigen::Vector3d to_place = place.at - (tip.translation() + hand.depth * ahead);
    const double before = to_place.dot(ahead);
    const bool is_in_line = (to_place - before * ahead).norm() < 1e-5;
    const bool is_near = before > -1e-5 && before < 0.08 * arm_reach(robot).length + 1e-5;
    const double lean = std::acos(std::min(1.0, ahead.dot(place.approach)));
    if (is_in_line && is_near && lean <= 25.001 * std::numbers::pi / 180) return true;
  }
  return false;
}

class SuiteFurniture : public testing::TestWithParam<const char*> {};

TEST_P(SuiteFurniture, BothEndsAreFreeByTheIndependentCheckAndGoalsAreGrasps) {
  const Robot robot = load_robot(GetParam());
  std::set<std::string> names;
  int grasps = 0, starts = 0;
  for (std::size_t i = 0; i < kinds; ++i) {
    const FurnitureScene scene = draw_cells(generator(56), i, robot, open, 0.0);
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    ASSERT_EQ(scene.problems.size(), problems_of_furniture);
    const ConfigurationSpace space(robot, scene.map, open);
    for (const StageProblem& problem : scene.problems) {
      ASSERT_EQ(problem.goals.size(), 1u);
      for (const Configuration& end : {problem.start, problem.goals[0]}) {
        const PathVerdict verdict = check_path(robot, scene.map, space.policies(), 0.0, {end});
        EXPECT_TRUE(verdict.valid) << problem.name << ": " << verdict.first_contact;
      }
      EXPECT_TRUE(is_grasp(scene, robot, problem.goals[0])) << problem.name;
      grasps += is_grasp(scene, robot, problem.start);
      ++starts;
    }
  }
  EXPECT_EQ(2 * grasps, starts);
}

INSTANTIATE_TEST_SUITE_P(Arms, SuiteFurniture, testing::Values("panda", "puma560", "arm6"),
                         [](const auto& robot) { return std::string(robot.param); });

TEST(SuiteFurnitureScenes, TheHandOfThePandaReachesAroundThings) {
  const Robot robot = load_robot("panda");
  int around = 0;
  for (std::size_t i = 0; i < 2 * kinds; ++i) {
    const FurnitureScene scene = draw_cells(generator(56), i, robot, open, 0.0);
    for (const StageProblem& problem : scene.problems) {
      const Eigen::Isometry3d tip = tip_pose(robot, problem.goals[0]);
      for (double z = -0.03; z <= 0.009; z += 0.005)  // between the fingers, which end 1 cm beyond the tip
        around += scene.map.state(tip * Eigen::Vector3d(0, 0, z)) == VoxelState::occupied;
    }
  }
  EXPECT_GT(around, 0);
}

void expect_grasps(const Robot& robot, const HandAtTip& hand) {
  for (std::size_t i = 0; i < kinds; ++i) {
    const FurnitureScene scene = draw_cells(generator(56), i, robot, open, 0.0);
    ASSERT_EQ(scene.problems.size(), problems_of_furniture) << scene.name;
    for (const StageProblem& problem : scene.problems)
      EXPECT_TRUE(is_grasp(scene, robot, problem.goals[0], hand)) << problem.name;
  }
}

/// As of MoveIt's Panda, whose tip is the flange.
TEST(SuiteFurnitureScenes, AHandBeyondTheTipReachesThePlacesInItsStead) {
  Robot robot = load_robot("panda");
  const double back = 0.1;
  robot.link_from_tip = robot.link_from_tip * Eigen::Translation3d(0.0, 0.0, -back);
  const HandAtTip hand = hand_at_tip(robot);
  EXPECT_NEAR(hand.depth, back + hand_at_tip(load_robot("panda")).depth, 1e-9);
  EXPECT_GT(hand.depth, 0.08 * arm_reach(robot).length);
  expect_grasps(robot, hand);
}

/// Of an arm whose shoulder is as low as a UR5's a cage would be in the floor.
TEST(SuiteFurnitureScenes, ACageStandsOnTheFloorWhereScenesHeldNoProblem) {
  const auto lowest = [](int attempt) {
    const Robot robot = load_robot("arm6");
    double least = 1.0;
    for (const SceneShape& solid : draw_furniture(robot, 1, 2, attempt).solids)
      if (solid.name.starts_with("bar")) least = std::min(least, solid.map_from_shape.translation().z());
    return least;
  };
  double before = 1.0, after = 1.0;
  for (int attempt = 0; attempt < 5; ++attempt) before = std::min(before, lowest(attempt));
  for (int attempt = 5; attempt < 10; ++attempt) after = std::min(after, lowest(attempt));
  EXPECT_LT(before, 0.0);
  EXPECT_GT(after, 0.0);
}

/// As of MoveIt's UR5, whose ee_link has x ahead.
TEST(SuiteFurnitureScenes, AHandPointsAlongTheLastJointWhereItsZDoesNot) {
  for (const char* name : {"panda", "puma560", "arm6"}) {
    Robot robot = load_robot(name);
    EXPECT_EQ(hand_at_tip(robot).axis, Eigen::Vector3d::UnitZ()) << name;
    robot.link_from_tip = robot.link_from_tip * Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY());
    EXPECT_TRUE(hand_at_tip(robot).axis.isApprox(Eigen::Vector3d::UnitX(), 1e-9))
        << name << ": " << hand_at_tip(robot).axis.transpose();
  }
  Robot robot = load_robot("arm6");
  robot.link_from_tip = robot.link_from_tip * Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY());
  expect_grasps(robot, {hand_at_tip(robot).axis, 0.0});
}

TEST(SuiteFurnitureScenes, AProblemIsTheSameWhateverTheCount) {
  const Robot robot = load_robot("arm6");
  const FurnitureScene few = draw_cells(generator(6), 1, robot, open, 0.0);
  const FurnitureScene many = draw_cells(generator(56), 1, robot, open, 0.0);
  ASSERT_EQ(few.problems.size(), 2u);
  ASSERT_EQ(many.problems.size(), 4u);
  EXPECT_EQ(few.problems[1].name, "tall bookshelf 1.2");
  for (std::size_t i = 0; i < few.problems.size(); ++i) {
    EXPECT_EQ(few.problems[i].start, many.problems[i].start);
    EXPECT_EQ(few.problems[i].goals, many.problems[i].goals);
  }
  EXPECT_EQ(map_sha256(few.map), map_sha256(many.map));
}

TEST(SuiteFurnitureScenes, AnotherSeedOrAttemptIsAnotherScene) {
  const Robot robot = load_robot("panda");
  const auto corner = [&](std::uint64_t seed, int attempt) {
    return Eigen::Vector3d(draw_furniture(robot, seed, 0, attempt).solids[1].map_from_shape.translation());
  };
  EXPECT_EQ(corner(1, 0), corner(1, 0));
  EXPECT_NE(corner(1, 0), corner(2, 0));
  EXPECT_NE(corner(1, 0), corner(1, 1));
}

TEST(SuiteFurnitureScenes, AnArmOfFiveJointsHoldsNoGraspAndIsRefused) {
  EXPECT_THROW(draw_cells(generator(1), 4, load_robot("arm5"), open, 0.0), std::runtime_error);
}

TEST(SuiteFurnitureScenes, TheSuiteHasThreeHundredProblemsForThreeArmsInTwoSizesOfVoxels) {
  const Suite suite = load_suite(CLEARWAY_SOURCE_DIR "/datasets/suites/cells.yaml");
  int problems = 0;
  std::set<std::string> robots;
  std::set<double> resolutions;
  for (const SuiteExperiment& experiment : suite.experiments) {
    ASSERT_TRUE(experiment.generate);
    EXPECT_EQ(experiment.generate->kind, "cells");
    EXPECT_EQ(experiment.generate->count % (kinds * problems_of_furniture), 0u);
    problems += experiment.generate->count;
    EXPECT_EQ(SuiteStages(suite, experiment, load_robot(experiment.robot)).size() * problems_of_furniture,
              static_cast<std::size_t>(experiment.generate->count));
    robots.insert(experiment.robot);
    resolutions.insert(experiment.generate->resolution);
  }
  EXPECT_GE(problems, 300);
  EXPECT_EQ(robots, (std::set<std::string>{"arm6", "panda", "puma560"}));
  EXPECT_EQ(resolutions, (std::set<double>{0.01, 0.02}));
}

}  // namespace suite_furniture_test
}  // namespace clearway
