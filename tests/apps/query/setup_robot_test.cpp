#include "apps/query/setup_robot.hpp"

#include <gtest/gtest.h>

#include "planning/robot/joint_names.hpp"
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

}  // namespace setup_robot_test
}  // namespace clearway
