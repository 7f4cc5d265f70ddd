#include "apps/query/setup_robot.hpp"

#include <gtest/gtest.h>

#include "planning/robot/joint_names.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace setup_robot_test {

using Names = std::vector<std::string>;

TEST(SetupRobot, MovesTheGroupInPlansAndAllThatIsRecordedElsewhere) {
  const TemporaryFolder folder;
  RobotSetup setup;
  setup.name = folder.write("arm.urdf", worlds::arm_with_finger());
  setup.map_from_base = Eigen::Translation3d(1, 2, 3);
  setup.terms.srdf =
      folder.write("other.srdf",
                   "<robot name='arm'><group name='two'><joint name='shoulder'/><joint name='elbow'/></group>"
                   "</robot>");
  setup.terms.group = "two";
  setup.terms.fixed = {{"grip", 0.0123456789012345}};
  const Robot planned = planned_robot(setup);
  EXPECT_EQ(joint_names(planned), (Names{"shoulder", "elbow"}));
  EXPECT_EQ(planned.held.at(0).value, 0.0123456789012345);
  EXPECT_EQ(planned.map_from_base.translation(), Eigen::Vector3d(1, 2, 3));
  const Robot recorded = recorded_robot(setup, {"grip"});
  EXPECT_EQ(joint_names(recorded), (Names{"shoulder", "elbow", "grip"}));
  EXPECT_EQ(recorded.tip_link, planned.tip_link);
  EXPECT_EQ(recorded.map_from_base.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(joint_names(recorded_robot(setup, {})), (Names{"shoulder", "elbow"}));
}

TEST(SetupRobot, FindsMeshesInItsPackages) {
  RobotSetup setup;
  setup.name = "panda";
  setup.terms.packages = {{"meshes_of", "/tmp"}};
  setup.terms.xacro = {{"prefix", "left_"}};
  EXPECT_EQ(choice_of(setup).packages, Names{"meshes_of=/tmp"});
  EXPECT_EQ(choice_of(setup).xacro, Names{"prefix:=left_"});
}

TEST(SetupRobot, AsAnEventChoosesItIsWhatTheSetupSaysAndTheEventDoesNot) {
  RobotSetup setup;
  setup.name = "robots/./arm.urdf";
  setup.scale = 0.5;
  setup.terms = {"arm.srdf", "left", {{"grip", 0.5}, {"lift", 0.25}}, {{"meshes", "/tmp"}}, {{"side", "l"}}};
  RobotChoice asked;
  asked.robot = "robots/arm.urdf";
  asked.fixed = {"grip=0.75"};
  RobotChoice chosen = with_terms_of(setup, asked);
  EXPECT_EQ(chosen.scale, 0.5);
  EXPECT_EQ(chosen.srdf, "arm.srdf");
  EXPECT_EQ(chosen.group, "left");
  EXPECT_EQ(chosen.fixed, (Names{"grip=0.75", "lift=0.25"}));
  EXPECT_EQ(chosen.packages, Names{"meshes=/tmp"});
  EXPECT_EQ(chosen.xacro, Names{"side:=l"});
  asked.group = "right";
  asked.scale = 1.0;
  chosen = with_terms_of(setup, asked);
  EXPECT_EQ(chosen.scale, 1.0);
  EXPECT_EQ(chosen.group, "right");
  EXPECT_EQ(chosen.fixed, Names{"grip=0.75"});
  EXPECT_EQ(chosen.srdf, "arm.srdf");
  asked.robot = "other.urdf";
  EXPECT_TRUE(with_terms_of(setup, asked).srdf.empty());
}

TEST(SetupRobot, SentencesNameTheKeysOfSetups) {
  RobotSetup setup;
  setup.name = "planar2";
  setup.terms.packages = {{"foo", "nowhere"}};
  EXPECT_EQ(complaint([&] { planned_robot(setup); }),
            "setup, robot, packages 'foo': there is no folder 'nowhere'");
  setup.terms.packages.clear();
  setup.terms.group = "one";
  EXPECT_EQ(
      complaint([&] { planned_robot(setup); }),
      "setup, robot, group 'one' of robot 'planar2': expected a SRDF that defines it, by srdf or beside the "
      "URDF");
}

}  // namespace setup_robot_test
}  // namespace clearway
