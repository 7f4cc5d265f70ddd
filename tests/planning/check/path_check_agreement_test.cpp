// Where the independent check compares its kinematics with the planners': wherever the robot can be.
#include <gtest/gtest.h>

#include <cmath>

#include "planning/check/path_check.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "tests/planning/check/comma_locale.hpp"
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

/// What programs ask that let motions pass without a check of each.
TEST(PathCheckAgreement, ARobotIsComparedWithItsFileWithoutAPath) {
  const worlds::UrdfRobot whip = worlds::whip();
  Robot robot = whip.robot();
  EXPECT_EQ(file_disagreement(robot), "");
  robot.links.back().parent_from_link.translate(Eigen::Vector3d(0.0, 0.0, 1e-6));
  EXPECT_NE(file_disagreement(robot).find("link 'lash' is 1e-06 m"), std::string::npos)
      << file_disagreement(robot);
}

TEST(PathCheckAgreement, ValuesWhoseDigitsAreLostAreRefused) {
  const worlds::UrdfRobot turner(
      "turner", "<link name='base'/>" + worlds::urdf_link("hand", "0.5 0 0", "<sphere radius='0.1'/>") +
                    worlds::urdf_joint("turn", "continuous", "base", "hand", "0 0 0", "0 0 1",
                                       "<limit effort='1' velocity='1'/>"));
  const auto said = [&](double value) {
    return check_path(
               turner.robot(), Snapshot(), {{"hand", Policy::not_occupied}}, 0.0,
               {Configuration::Constant(1, value), Configuration::Constant(1, std::nextafter(value, 2e17))})
        .first_contact;
  };
  EXPECT_EQ(said(1e6 - 1.0), "");
  EXPECT_NE(said(1e16).find("waypoint 0: joint turn is 1e+16, where angles have lost their digits"),
            std::string::npos)
      << said(1e16);
  EXPECT_NE(said(-1e16).find("have lost their digits"), std::string::npos);
}

TEST(PathCheckAgreement, ItsSentenceIsTheSameInEveryLocale) {
  const worlds::UrdfRobot whip = worlds::whip();
  Robot robot = whip.robot();
  robot.bodies.back().link_from_shape.translation().x() += 0.0125;
  expect_same_in_every_locale([&] { return disagreement(robot); },
                              "is 0.0125 m and 0 rad away from where kdl_parser puts it");
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
