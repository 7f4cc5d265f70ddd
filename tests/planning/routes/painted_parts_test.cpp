#include "planning/routes/painted_parts.hpp"

#include <gtest/gtest.h>

#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/part_policies.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace painted_parts_test {

Robot painted_point() {
  Robot robot = load_robot("point");
  robot.critical_parts = {robot.bodies.front().part};
  return robot;
}

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// Spheres along the x axis, but for a gap of `gap` metres at x = 1.
VoxelScene stroke(const Robot& robot, double gap) {
  VoxelScene scene{0.05, {}, {}, robot.critical_parts};
  for (double x = -0.5; x <= 2.51; x += 0.1) {
    if (std::abs(x - 1.0) > gap / 2 + 0.35) scene.painted.push_back({{x, 0.0, 0.0}, 0.35});
  }
  if (gap == 0.0) scene.painted.push_back({{1.0, 0.0, 0.0}, 0.6});
  return scene;
}

TEST(PaintedParts, StartAndGoalInDifferentPiecesOfTheVolumeAreReported) {
  const Robot robot = painted_point();
  const PathCost cost(robot);
  for (const double gap : {0.0, 0.2}) {
    const ConfigurationSpace space(robot, stroke(robot, gap).snapshot());
    const PlanProblem problem{space, cost, at(0.0, 0.0), at(2.0, 0.0)};
    ASSERT_TRUE(space.is_free(problem.start) && space.is_free(problem.goal))
        << space.check(problem.start).sentence();
    const std::string sentence = parted_volume_sentence(problem);
    for (const char* planner : {"beam", "beam_reference"}) {
      const PlanResult result = make_planner(planner, {{"step", "0.05"}, {"width", "20"}})->plan(problem);
      if (gap == 0.0) {
        EXPECT_EQ(sentence, "");
        EXPECT_EQ(result.status, PlanStatus::solved) << result.explanation;
        continue;
      }
      EXPECT_NE(sentence.find(robot.critical_parts[0]), std::string::npos) << sentence;
      EXPECT_NE(sentence.find("2 pieces"), std::string::npos) << sentence;
      EXPECT_EQ(result.status, PlanStatus::no_path);
      EXPECT_NE(result.explanation.find("2 pieces that do not overlap"), std::string::npos)
          << result.explanation;
    }
    EXPECT_EQ(parted_volume_sentence({space, cost, at(0.0, 0.0), at(0.3, 0.0)}), "");
  }
}

TEST(PaintedParts, ThePieceOfAMeshThatDoesNotHoldItsOwnOriginIsFoundByItsMiddle) {
  Robot robot = painted_point();
  std::vector<Eigen::Vector3d> corners;  // of a cube beside the origin
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? 0.06 : 0.16, i & 2 ? 0.05 : -0.05, i & 4 ? 0.05 : -0.05);
  robot.bodies.front().shape = Shape::convex(corners);
  robot.bodies.front().cover = robot.bodies.front().shape.sphere_cover();
  const PathCost cost(robot);
  for (const double gap : {0.0, 0.2}) {
    const ConfigurationSpace space(robot, stroke(robot, gap).snapshot());
    const PlanProblem problem{space, cost, at(0.0, 0.0), at(2.0, 0.0)};
    ASSERT_TRUE(space.is_free(problem.start) && space.is_free(problem.goal));
    EXPECT_EQ(parted_volume_sentence(problem).empty(), gap == 0.0);
  }
}

TEST(PaintedParts, OutOfTimeItSaysNothing) {
  const Robot robot = painted_point();
  const PathCost cost(robot);
  const ConfigurationSpace space(robot, stroke(robot, 0.2).snapshot());
  PlanProblem problem{space, cost, at(0.0, 0.0), at(2.0, 0.0)};
  EXPECT_NE(parted_volume_sentence(problem), "");
  problem.out_of_time = [] { return true; };
  EXPECT_EQ(parted_volume_sentence(problem), "");
}

TEST(PaintedParts, AVolumeWithoutASphereIsReportedInPlaceOfTheFirstBlockedVoxel) {
  const Robot robot = painted_point();
  const PathCost cost(robot);
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("for the hand", robot.critical_parts);
  map.paint(map.add_volume("for another part", {"gripper"}), {{0.0, 0.0, 0.0}, 1.0});
  const ConfigurationSpace space(robot, map.snapshot());
  ASSERT_EQ(space.policies().at(robot.critical_parts[0]), Policy::painted);
  const std::string sentence = empty_volume_sentence(space);
  EXPECT_NE(sentence.find("'" + robot.critical_parts[0] + "'"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("no ball is painted"), std::string::npos) << sentence;
  for (const char* planner : {"beam", "beam_reference"}) {
    const PlanResult result = make_planner(planner)->plan({space, cost, at(0.0, 0.0), at(1.0, 0.0)});
    EXPECT_EQ(result.status, PlanStatus::start_invalid);
    EXPECT_NE(result.explanation.find(sentence), std::string::npos) << result.explanation;
  }
  const ConfigurationSpace painted(robot, stroke(robot, 0.2).snapshot());
  EXPECT_EQ(empty_volume_sentence(painted), "");
}

TEST(PaintedParts, APaintedPolicyInAMapWithoutPaintIsReported) {
  const Robot robot = painted_point();
  Policies policies;
  policies.parts[robot.critical_parts[0]] = Policy::painted;
  const ConfigurationSpace bare(robot, VoxelScene{}.snapshot(), policies);
  EXPECT_NE(empty_volume_sentence(bare), "");
  EXPECT_EQ(empty_volume_sentence(ConfigurationSpace(robot, VoxelScene{}.snapshot())), "");  // known_free
}

}  // namespace painted_parts_test
}  // namespace clearway
