// What is in a foreign robot's hand, as loads.
#include "apps/problem_sets/attached_loads.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace {

class ForeignAttachedLoads : public ::testing::Test {
 protected:
  ForeignAttachedLoads()
      : robot_(load_robot(folder_.write("arm.urdf", worlds::arm_with_finger()))),
        start_(Configuration::Zero(3)) {
    start_ << 0.4, -0.9, 0.03;
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      map_from_[robot_.links[i].name] = forward_kinematics(robot_, start_)[i];
  }

  static ForeignSolid box_at(const Eigen::Isometry3d& frame_from_shape) {
    ForeignSolid solid;
    solid.kind = "box";
    solid.shape = Shape::box({0.1, 0.2, 0.3});
    solid.map_from_shape = frame_from_shape;
    return solid;
  }

  TemporaryFolder folder_;
  Robot robot_;
  Configuration start_;
  std::map<std::string, Eigen::Isometry3d> map_from_;
};

TEST_F(ForeignAttachedLoads, StandWhereTheyAreAtTheStartWhateverFrameTheyAreIn) {
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(0.1, 0.2, -0.3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3.0);
  for (const std::string frame : {"", "lower", "upper", "base", "finger"}) {
    const AttachedLoads made = loads_of({{"can", "finger", frame, {}, {box_at(pose)}}}, robot_, start_);
    ASSERT_EQ(made.loads.size(), 1U) << frame;
    const Load& load = made.loads[0].load;
    EXPECT_EQ(load.link, "finger");
    EXPECT_TRUE(made.loads[0].legs.empty());
    const Eigen::Isometry3d map_from_load = map_from_["finger"] * load.link_from_load;
    const Eigen::Isometry3d expected = frame.empty() ? pose : map_from_[frame] * pose;
    EXPECT_TRUE(map_from_load.isApprox(expected, 1e-12)) << frame;
  }
}

TEST_F(ForeignAttachedLoads, EachPieceIsALoadAndAMeshItsHull) {
  ForeignSolid sheet = box_at(Eigen::Isometry3d::Identity());
  sheet.kind = "mesh";
  sheet.triangles = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const ForeignAttached body{
      "lower", "lower", "lower", {"finger", "a table", "lower"}, {box_at(sheet.map_from_shape), sheet}};
  const AttachedLoads made = loads_of({body, {"plain air", "lower", "", {}, {}}}, robot_, start_);
  ASSERT_EQ(made.loads.size(), 2U);
  EXPECT_EQ(made.loads[0].load.name, "lower-2");  // the link has the name
  EXPECT_EQ(made.loads[1].load.name, "lower-3");
  EXPECT_EQ(made.loads[0].load.touches, std::vector<std::string>{"finger"});
  EXPECT_EQ(made.loads[1].load.shape.vertices().size(), 4U);
  EXPECT_NEAR(made.loads[1].load.shape.support({1, 1, 1}).sum(), 1.0, 1e-12);
  EXPECT_EQ(made.left_out, std::vector<std::string>{"attached body 'plain air', of which it shows no shape"});
}

TEST_F(ForeignAttachedLoads, EachPieceHasItsPartOfTheWeight) {
  const ForeignSolid box = box_at(Eigen::Isometry3d::Identity());
  const AttachedLoads made =
      loads_of({{"can", "finger", "finger", {}, {box, box}, 1.5}, {"air", "finger", "finger", {}, {box}}},
               robot_, start_);
  ASSERT_EQ(made.loads.size(), 3U);
  EXPECT_EQ(made.loads[0].load.mass, 0.75);
  EXPECT_EQ(made.loads[1].load.mass, 0.75);
  EXPECT_EQ(made.loads[2].load.mass, 0.0);
}

/// The hull of so many points takes seconds; what is refused is their number, whatever the hull would be.
TEST_F(ForeignAttachedLoads, AMeshOfTooManyPointsIsRefusedByTheirNumber) {
  ForeignSolid mesh = box_at(Eigen::Isometry3d::Identity());
  mesh.kind = "mesh";
  for (int i = 0; i < 50'001; ++i)
    mesh.triangles.emplace_back(1e-3 * (i % 37), 1e-3 * (i / 37 % 37), 1e-3 * (i / 1369));
  for (int i = 0; i < 3; ++i) mesh.triangles.push_back(mesh.triangles.front());  // points count once
  try {
    loads_of({{"bun", "finger", "finger", {}, {mesh}}}, robot_, start_);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "attached body 'bun': its mesh has 50001 points, expected at most 50000");
  }
  mesh.triangles.erase(mesh.triangles.begin() + 50'000);
  EXPECT_EQ(loads_of({{"bun", "finger", "finger", {}, {mesh}}}, robot_, start_).loads.size(), 1U);
}

TEST_F(ForeignAttachedLoads, FramesAndLinksThatTheRobotLacksAreNamed) {
  const AttachedLoads made =
      loads_of({{"can", "lower", "tray", {}, {box_at(Eigen::Isometry3d::Identity())}}}, robot_, start_);
  EXPECT_TRUE(made.loads.empty());
  EXPECT_EQ(made.left_out,
            std::vector<std::string>{"attached body 'can' in frame 'tray', which is no link of the robot"});
  try {
    loads_of({{"can", "loser", "loser", {}, {box_at(Eigen::Isometry3d::Identity())}}}, robot_, start_);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "load 'can': robot 'arm' has no link 'loser', did you mean 'lower'?");
  }
}

}  // namespace
}  // namespace clearway
