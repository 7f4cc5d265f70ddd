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

}  // namespace path_check_agreement_test
}  // namespace clearway::check
