#include "apps/teach/ball_size.hpp"

#include <gtest/gtest.h>

#include <set>

namespace clearway {
namespace ball_size_test {

VirtualRobot robot_of(const std::string& name, std::optional<double> scale = {}) {
  RobotChoice choice;
  choice.robot = name;
  choice.scale = scale;
  choice.padding = 0.001;
  return VirtualRobot(choice, {});
}

/// A disc of 0.2 m that slides: the cylinder is the disc itself; at another scale it is as much smaller.
TEST(BallSize, TheHandIsTheNarrowestCylinderRoundWhatStaysInPaint) {
  EXPECT_LE(hand_radius(robot_of("point")), 0.201 + 1e-9);
  const double full = hand_radius(robot_of("panda", 1.0)), half = hand_radius(robot_of("panda", 0.5));
  EXPECT_NEAR(half - 0.001, 0.5 * (full - 0.001), 1e-9);
  RobotChoice free;
  free.robot = "point";
  for (const char* policy : {"base=not_occupied", "not_occupied"}) {
    free.policies = {policy};
    EXPECT_EQ(hand_radius(VirtualRobot(free, {})), 0.0) << policy;
  }
}

/// Each point of what stays in paint lies in the cylinder, whose length alone is left open.
TEST(BallSize, ABallIsComparedWithTheHandAndItsPadding) {
  const VirtualRobot robot = robot_of("panda");
  const double hand = hand_radius(robot);
  EXPECT_EQ(ball_for_hand(hand, robot), "");
  const std::string sentence = ball_for_hand(0.9 * hand, robot);
  EXPECT_NE(sentence.find("is narrower than what of robot 'panda' has to stay in paint"), std::string::npos)
      << sentence;
  EXPECT_NE(sentence.find("strokes side by side do"), std::string::npos);
  const std::vector<std::string> parts = robot.painted_parts();
  EXPECT_EQ(std::set<std::string>(parts.begin(), parts.end()).size(), parts.size()) << sentence;
}

TEST(BallSize, ABallThatIsNotSureToHoldAVoxelSaysHowLargeItMustBe) {
  EXPECT_EQ(ball_for_voxels(0.0225, 0.0025), "");
  EXPECT_EQ(ball_for_voxels(0.0347, 0.02), "");
  EXPECT_EQ(ball_for_voxels(0.02, 0.02),
            "the probe's ball, 20 mm in radius, does not always hold a voxel of 20 mm as a whole, and only "
            "such voxels are painted: expected a ball of 34.6 mm and what tracking may be off, or "
            "--resolution 0.011 or less");
  EXPECT_EQ(ball_for_voxels(0.02, 0.011), "") << "what it advises is enough";
  EXPECT_NE(ball_for_voxels(0.017, 0.02).find(", holds no voxel of 20 mm as a whole"), std::string::npos);
}

}  // namespace ball_size_test
}  // namespace clearway
