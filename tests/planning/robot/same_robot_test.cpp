#include "planning/robot/same_robot.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace same_robot_test {

TEST(SameRobot, ACopyIsTheSameAndSoIsOneOfAnotherName) {
  const Robot robot = load_robot("panda");
  Robot copy = robot;
  EXPECT_TRUE(is_same(robot, copy));
  copy.name = "another";
  copy.links[2].mass += 1.0;
  EXPECT_TRUE(is_same(robot, copy));
}

TEST(SameRobot, NothingThatMovesABodyMayDiffer) {
  const Robot robot = load_robot("panda");
  const std::vector<std::function<void(Robot&)>> changes{
      [](Robot& other) { other.joints[1].upper += 1e-15; },
      [](Robot& other) { other.joints[3].axis = -other.joints[3].axis; },
      [](Robot& other) { other.joints.pop_back(); },
      [](Robot& other) { other.links[3].parent_from_link.translation().x() += 1e-12; },
      [](Robot& other) { other.links[3].offset = 0.1; },
      [](Robot& other) { other.links[4].is_held = true; },
      [](Robot& other) { other.bodies[2].link_from_shape.translation().y() += 1e-12; },
      [](Robot& other) { other.bodies[2].shape = Shape::sphere(0.1); },
      [](Robot& other) { other.bodies[2].cover.front().radius += 1e-12; },
      [](Robot& other) { other.bodies.pop_back(); },
      [](Robot& other) { other.exempt.pop_back(); },
      [](Robot& other) { other.map_from_base.translation().z() += 1e-12; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Robot other = robot;
    changes[i](other);
    EXPECT_FALSE(is_same(robot, other)) << "change " << i;
    EXPECT_FALSE(is_same(other, robot)) << "change " << i;
  }
}

}  // namespace same_robot_test
}  // namespace clearway
