#include "datasets/ros/transform_tree.hpp"

#include <gtest/gtest.h>

#include "datasets/ros/transform_faults.hpp"

namespace clearway {
namespace transform_tree_test {

Eigen::Isometry3d pose(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

RosTransform transform(double time, const std::string& parent, const std::string& child,
                       const Eigen::Isometry3d& pose) {
  return {{time, parent}, child, pose.translation(), Eigen::Quaterniond(pose.linear())};
}

TEST(TransformTree, GoesUpAndDownAndBetweenTimes) {
  TransformTree tree;
  const Eigen::Isometry3d turn = pose(1, 0, 0) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  tree.add(transform(0, "a", "b", pose(0, 0, 0)), false, 0);
  tree.add(transform(1, "a", "b", turn), false, 0);
  tree.add(transform(5, "a", "b", turn), false, 0);
  tree.add(transform(0, "a", "c", pose(0, 0, 7)), true, 0);
  const auto half = tree.root_from_frame("c", "b", 0.5, 0);
  ASSERT_TRUE(half);
  EXPECT_TRUE(half->isApprox(pose(0.5, 0, -7) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()), 1e-12));
  EXPECT_FALSE(tree.root_from_frame("c", "b", -0.1, 0)) << "before the first";
  EXPECT_FALSE(tree.root_from_frame("c", "b", 3.0, 0)) << "4 s apart";
  EXPECT_TRUE(tree.root_from_frame("c", "b", 5.0, 0)) << "at a pose itself";
  EXPECT_FALSE(tree.root_from_frame("x", "b", 0.5, 0));
  EXPECT_TRUE(tree.root_from_frame("x", "x", 0.5, 0)->isApprox(Eigen::Isometry3d::Identity()));
}

TEST(TransformTree, LeavesOutWhatIsNoTransform) {
  TransformTree tree;
  RosTransform wrong = transform(0, "a", "b", pose(0, 0, 0));
  wrong.rotation.coeffs() *= 1.1;
  tree.add(wrong, false, 0);
  tree.add(transform(0, "b", "b", pose(0, 0, 0)), false, 0);
  EXPECT_EQ(tree.left_out(), 2U);
  EXPECT_TRUE(tree.frames().empty());
  tree.add(transform(0, "a", "b", pose(0, 0, 1)), true, 0);
  tree.add(transform(0, "b", "a", pose(0, 0, 1)), true, 0);  // a circle: no chain ends, none is found twice
  EXPECT_TRUE(tree.root_from_frame("a", "b", 0.0, 0));
}

TEST(TransformTree, SaysWhenAllFramesOfAWayHavePosesAndOnlyOfOneThatJoins) {
  TransformTree tree;
  for (int time = 0; time <= 10; ++time) {
    tree.add(transform(time, "map", "odom", pose(0, 0, 0)), false, time);
    tree.add(transform(time + 4, "odom", "base", pose(0, 0, 0)), false, time);
    tree.add(transform(time + 20, "base", "late", pose(0, 0, 0)), false, time);
  }
  tree.add(transform(0, "rig", "lidar", pose(0, 0, 1)), true, 0);
  EXPECT_EQ(tree.times_between("map", "base"), (std::pair{4.0, 10.0}));
  EXPECT_EQ(tree.times_between("odom", "base"), (std::pair{4.0, 14.0}));
  EXPECT_EQ(tree.times_between("map", "late"), (std::pair{20.0, 10.0})) << "never all together";
  EXPECT_FALSE(tree.times_between("odom", "lidar")) << "what moves above them joins them not";
  EXPECT_FALSE(tree.are_joined("odom", "lidar"));
  EXPECT_TRUE(tree.are_joined("late", "odom"));
}

/// A robot of two sensors that drives in its odometry, which stands nearly still in the map.
TransformTree driving(double metres) {
  TransformTree tree;
  for (int time = 0; time <= 10; ++time) {
    tree.add(transform(time, "odom", "base", pose(metres * time / 10.0, 0, 0)), false, time);
    tree.add(transform(time, "map", "odom", pose(0, 0.01 * time, 0)), false, time);
    tree.add(transform(time, "base", "hand", pose(0, 0, 0.1 * time)), false, time);
  }
  tree.add(transform(0, "base", "camera", pose(0, 0, 1)), true, 0);
  return tree;
}

TEST(TransformFaults, ARootThatDrivesWithItsSensorsIsTold) {
  const auto told = [](const TransformTree& tree, const std::string& root, const std::string& sensor) {
    std::string all;
    for (const std::string& clause : tell_contradictions(tree, root, {sensor})) all += clause;
    return all;
  };
  const TransformTree tree = driving(3.0);
  const std::string clause = told(tree, "base", "camera");
  EXPECT_NE(clause.find("'base', in which all is placed, move by 3 m in 'map'"), std::string::npos) << clause;
  EXPECT_NE(told(tree, "camera", "camera"), "");  // itself
  EXPECT_EQ(told(tree, "odom", "camera"), "");
  EXPECT_EQ(told(tree, "map", "camera"), "");
  EXPECT_EQ(told(tree, "base", "hand"),
            "");  // a sensor on an arm looks at what rides along, or the base stands
  EXPECT_EQ(told(driving(0.05), "base", "camera"), "");
  TransformTree parked;  // which finds out where it is, in one step
  for (int time = 0; time <= 10; ++time)
    parked.add(transform(time, "map", "odom", pose(time < 4 ? 0.0 : 0.35, 0, 0)), false, time);
  parked.add(transform(0, "odom", "camera", pose(0, 0, 1)), true, 0);
  EXPECT_EQ(told(parked, "odom", "camera"), "");
  EXPECT_NEAR(parked.longest_step_of("odom"), 0.35, 1e-12);
  EXPECT_EQ(parked.longest_step_of("camera"), 0.0);
}

}  // namespace transform_tree_test
}  // namespace clearway
