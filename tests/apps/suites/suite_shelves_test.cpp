#include "apps/suites/suite_shelves.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_shelves_test {

const SuiteGenerator coarse{.kind = "shelves", .count = 13, .seed = 2, .resolution = 0.04};
const Policies open{.parts = {}, .critical_by_default = false};

/// The box of the solid of that name, and the point in its own frame.
Eigen::Vector3d in_frame(const Shelf& shelf, const std::string& name, const Eigen::Vector3d& point) {
  for (const SceneShape& solid : shelf.world.solids)
    if (solid.name == name) return solid.map_from_shape.inverse() * point;
  throw std::logic_error("no solid " + name);
}

/// Which compartment holds a point, counted by the boards below it and the sides to its right; -1: none.
int compartment(const Shelf& shelf, const Eigen::Vector3d& point) {
  int boards = 0, sides = 0;
  for (const char* name : {"board 0", "board 1", "board 2", "board 3"})
    boards += in_frame(shelf, name, point).z() > 0.0;
  for (const char* name : {"side 0", "side 1", "side 2", "side 3"})
    sides += in_frame(shelf, name, point).y() > 0.0;
  const double depth = in_frame(shelf, "board 0", point).x();
  const bool inside = boards >= 1 && boards <= 3 && sides >= 1 && sides <= 3 && std::abs(depth) < 0.18;
  return inside ? boards * 10 + sides : -1;
}

TEST(SuiteShelves, ProblemsLeadFromOneCompartmentToAnotherAndTheirEndsAreFree) {
  const Robot robot = load_robot("puma560");
  const Shelf shelf = draw_shelf(coarse, 0, robot, open, 0.0);
  const ConfigurationSpace space(robot, shelf.map, open);
  ASSERT_EQ(shelf.problems.size(), problems_of_a_shelf);
  for (const StageProblem& problem : shelf.problems) {
    ASSERT_EQ(problem.goals.size(), 1u);
    const Eigen::Isometry3d from = tip_pose(robot, problem.start), to = tip_pose(robot, problem.goals[0]);
    const int first = compartment(shelf, from.translation()), second = compartment(shelf, to.translation());
    EXPECT_GT(first, 0) << problem.name;
    EXPECT_GT(second, 0) << problem.name;
    EXPECT_NE(first, second) << problem.name;
    // The independent check's word: an end is a path of no length.
    for (const Configuration& end : {problem.start, problem.goals[0]})
      EXPECT_TRUE(check_path(robot, shelf.map, space.policies(), 0.0, {end, end}).valid) << problem.name;
    EXPECT_FALSE(check_path(robot, shelf.map, space.policies(), 0.0, {problem.start, problem.goals[0]}).valid)
        << problem.name;
  }
}

TEST(SuiteShelves, TheLastShelfHasWhatIsLeftOfTheProblems) {
  const Robot robot = load_robot("puma560");
  const Shelf last = draw_shelf(coarse, 1, robot, open, 0.0);
  EXPECT_EQ(last.problems.size(), 3u);
  EXPECT_EQ(last.problems[2].name, "shelf 2.3");
  const Shelf again = draw_shelf(coarse, 1, robot, open, 0.0);
  EXPECT_EQ(last.problems[2].goals, again.problems[2].goals);
  EXPECT_EQ(map_sha256(last.map), map_sha256(again.map));
}

TEST(SuiteShelves, TheSensorsSeeEveryBoardFromTheFront) {
  const Shelf shelf = draw_shelf(coarse, 0, load_robot("puma560"), open, 0.0);
  for (const SceneShape& solid : shelf.world.solids) {
    if (solid.name.rfind("board", 0) != 0) continue;
    const Eigen::Vector3d size = std::get<BoxShape>(solid.geometry).size;
    int occupied = 0, looked = 0;
    for (double y = -0.45; y <= 0.45; y += 0.01) {  // along its front edge
      const Eigen::Vector3d at =
          solid.map_from_shape * Eigen::Vector3d(-size.x() / 2 + 1e-3, y * size.y(), 0);
      ++looked;
      occupied += shelf.map.state(at) == VoxelState::occupied;
    }
    EXPECT_GT(occupied, 0.9 * looked) << solid.name;
  }
}

}  // namespace suite_shelves_test
}  // namespace clearway
