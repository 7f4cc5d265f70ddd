// Where the independent check compares its kinematics with the planners': wherever the robot can be.
#include <gtest/gtest.h>

#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway::check {
namespace path_check_agreement_test {

TEST(PathCheckAgreement, IsLookedForAtEitherLimitAndNotBeyond) {
  for (const auto& [lower, upper] : {std::pair(-1.0, 3.0), std::pair(-3.0, 1.0), std::pair(1.0, 3.0)}) {
    const worlds::UrdfRobot slider(
        "slider", "<link name='base'/>" + worlds::urdf_link("hand", "0 0 0", "<sphere radius='0.1'/>") +
                      worlds::urdf_joint("slide", "prismatic", "base", "hand", "0 0 0", "1 0 0",
                                         worlds::urdf_limit(lower, upper)));
    /// With an axis that is too long, so that the hand is so far from its place at the farther limit.
    const auto agrees = [&, farthest = 3.0](double apart) {
      Robot robot = slider.robot();
      robot.joints[0].axis *= 1.0 + apart / farthest;
      try {
        require_same_poses(robot, KdlArm(robot));
      } catch (const FileDisagrees&) {
        return false;
      }
      return true;
    };
    EXPECT_TRUE(agrees(0.0));
    EXPECT_TRUE(agrees(0.999e-9)) << lower << " to " << upper;
    EXPECT_FALSE(agrees(1.001e-9)) << lower << " to " << upper;
  }
}

std::string disagreement(const Robot& robot) {
  try {
    require_same_poses(robot, KdlArm(robot));
  } catch (const FileDisagrees& error) {
    return error.what();
  }
  return "";
}

/// Half a turn about an axis that is off by so much turns the link by twice as much, and moves nothing.
TEST(PathCheckAgreement, ATurnOfMoreThanANanoradIsNamedWithItsLink) {
  const worlds::UrdfRobot turner(
      "turner", "<link name='base'/>" + worlds::urdf_link("hand", "0 0 0", "<sphere radius='0.1'/>") +
                    worlds::urdf_joint("turn", "revolute", "base", "hand", "0 0 0", "0 0 1",
                                       worlds::urdf_limit(0.0, 3.141592653589793)));
  const auto told = [&](double turned) {
    Robot robot = turner.robot();
    robot.joints[0].axis = Eigen::Vector3d(turned / 2, 0.0, 1.0).normalized();
    return disagreement(robot);
  };
  EXPECT_EQ(told(0.0), "");
  EXPECT_EQ(told(0.99e-9), "");
  EXPECT_NE(told(1.01e-9).find("link 'hand' is "), std::string::npos) << told(1.01e-9);
}

TEST(PathCheckAgreement, ABodyThatIsElsewhereOnItsLinkIsNamed) {
  const worlds::UrdfRobot whip = worlds::whip();
  for (const double off : {0.99e-9, 1.01e-9}) {
    for (int axis = 0; axis < 3; ++axis) {
      Robot robot = whip.robot();
      robot.bodies.back().link_from_shape.translation()[axis] += off;
      const std::string told = disagreement(robot);
      EXPECT_EQ(told.empty(), off < 1e-9) << told;
      EXPECT_TRUE(told.empty() || told.find("a body of link 'lash'") != std::string::npos) << told;
    }
  }
}

}  // namespace path_check_agreement_test
}  // namespace clearway::check
