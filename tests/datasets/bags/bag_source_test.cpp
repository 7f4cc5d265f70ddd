#include "datasets/bags/bag_source.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "datasets/bags/mcap_writer.hpp"
#include "datasets/ros/ros_encoders.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace bag_source_test {

/// A driver says NaN of what it does not know: that is no reading of this joint, and all the others are.
TEST(BagSource, AJointThatIsNotFiniteIsNotReadThenAndTheOthersAre) {
  const TemporaryFolder folder;
  const double unknown = std::numeric_limits<double>::quiet_NaN(), never = HUGE_VAL;
  {
    McapWriter bag(folder / "arm.mcap");
    const auto topic = bag.add_topic("/joint_states", joint_state_type().name, joint_state_type().definition);
    const std::vector<std::string> names = {"shoulder", "elbow", "gripper"};
    bag.write(topic, 1.0, encode_joints(1.0, names, Eigen::Vector3d(0.1, 0.4, unknown)));
    bag.write(topic, 1.1, encode_joints(1.1, names, Eigen::Vector3d(0.2, never, unknown)));
    bag.write(topic, 1.2, encode_joints(1.2, names, Eigen::Vector3d(0.3, 0.6, unknown)));
    bag.finish();
  }
  const JointStream joints = read_joints(folder / "arm.mcap", "/joint_states");
  EXPECT_EQ(joints.names(), (std::vector<std::string>{"elbow", "shoulder"}));
  EXPECT_EQ(joints.times({"shoulder"}).size(), 3U);
  EXPECT_EQ(joints.times({"shoulder", "elbow"}).size(), 2U);
  const auto between = joints.at({"shoulder", "elbow"}, 1.1);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->front(), 0.2, 1e-9);
  EXPECT_NEAR(between->back(), 0.5, 1e-9);
}

}  // namespace bag_source_test
}  // namespace clearway
