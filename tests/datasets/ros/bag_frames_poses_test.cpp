// Where the scans of bags were taken: transforms that contradict each other, are fixed or missing.

#include "datasets/ros/bag_frames.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/datasets/ros/bag_frames_world.hpp"

namespace clearway {
namespace bag_frames_poses_test {

using namespace bag_frames_world;

TEST_F(BagFramesTest, TwoPublishersOfOneFrameAreRefusedWhereTheyAlternate) {
  for (const char* name : {"two.mcap", "two.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    for (double time = 10.02; time < 13; time += 0.05) bag.transform(time, "map", "base", elsewhere_at(time));
    bag.sort();
    const Reading reading = read(bag, name);
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find("poses of frame 'base' are up to 1"), std::string::npos) << reading.damage;
  }
}

/// A second parent of the base, which says that it is elsewhere.
void add_second_parent(ScanBag& bag, bool in_map, bool is_first) {
  if (is_first) bag.transform(9.8, "vodom", "base", elsewhere_at(10));
  for (double time = 10.02; time < 13; time += 0.05) bag.transform(time, "vodom", "base", elsewhere_at(time));
  if (in_map) bag.transform(9.9, "map", "vodom", Eigen::Isometry3d::Identity(), true);
  bag.sort();
}

TEST_F(BagFramesTest, AFrameOfWhichTwoParentsLeadToTheMapIsRefused) {
  for (const bool is_first : {false, true}) {
    ScanBag bag(folder_ / "two.mcap");
    add_run(bag, 0);
    add_second_parent(bag, true, is_first);
    const Reading reading = read(bag, "two.mcap");
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find(is_first ? "gives frame 'base' two parents, 'vodom' (61 transforms) and "
                                             "'map' (61 transforms), and both lead to 'map'"
                                           : "gives frame 'base' two parents, 'map' (61 transforms) and "
                                             "'vodom' (60 transforms), and both lead to 'map'"),
              std::string::npos)
        << reading.damage;
  }
}

TEST_F(BagFramesTest, OfTwoParentsTheOneThatLeadsToTheMapCounts) {
  for (const bool is_first : {false, true}) {
    ScanBag bag(folder_ / "two.mcap");
    add_run(bag, 0);
    add_second_parent(bag, false, is_first);
    const Reading reading = read(bag, "two.mcap");
    ASSERT_EQ(reading.frames.size(), 4U) << reading.damage;
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
    EXPECT_NE(reading.warnings.find("gives frame 'base' two parents, 'map' (61 transforms) and 'vodom'"),
              std::string::npos)
        << reading.warnings;
  }
}

TEST_F(BagFramesTest, AFrameBesideTheWayMayHaveTwoParents) {
  ScanBag bag(folder_ / "two.mcap");
  add_run(bag, 0);
  bag.transform(10, "map", "cup", mount());
  bag.transform(11, "base", "cup", mount());
  bag.transform(9, "earth", "map", mount(), true);  // above the frame in which sensors are placed
  bag.transform(9, "utm", "map", mount(), true);
  bag.sort();
  const Reading reading = read(bag, "two.mcap");
  ASSERT_EQ(reading.frames.size(), 4U) << reading.damage;
  for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  EXPECT_NE(reading.warnings.find("frame 'cup' two parents, 'map' (1 transforms) and 'base' (1 transforms)"),
            std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, TransformsInALoopAreRefused) {
  for (const bool is_last : {false, true}) {  // whichever of the two a bag holds first
    ScanBag bag(folder_ / "loop.mcap");
    const auto back = [&] { bag.transform(9, "base", "map", base_at(10), true); };
    if (!is_last) back();
    add_run(bag, 0);
    if (is_last) back();
    bag.sort();
    const Reading reading = read(bag, "loop.mcap");
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find("transforms in a loop: 'base' in 'map' in 'base', as of two publishers"),
              std::string::npos)
        << reading.damage;
  }
}

TEST_F(BagFramesTest, SinglePosesThatContradictOthersOfTheirTimeAreReported) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (const double time : {10.4, 10.9}) {
    bag.transform(time, "map", "base", elsewhere_at(time));
    bag.transform({time + 0.01, time}, "map", "base", base_at(time));
    bag.transform({time + 0.01, time}, "map", "base", base_at(time));  // the same again
  }
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  ASSERT_EQ(reading.frames.size(), 4U);
  expect_pose(reading.frames[0], base_at(10.53) * mount());
  EXPECT_NE(
      reading.warnings.find("poses of frame 'base' that contradict others of the same time, by up to 1 m"),
      std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, AFixedFrameThatIsMovedIsInItsNewPlaceFromThenOn) {
  const Eigen::Isometry3d moved = mount() * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  for (const char* name : {"moved.mcap", "moved.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    bag.transform(11.2, "base", "sensor", mount(), true);  // said again
    bag.transform(11.5, "base", "sensor", moved, true);
    bag.sort();
    const Reading reading = read(bag, name);
    ASSERT_EQ(reading.frames.size(), 4U);
    for (const Frame& frame : reading.frames)
      expect_pose(frame, base_at(frame.time) * (frame.time < 11.5 ? mount() : moved));
    EXPECT_NE(
        reading.warnings.find("moves the fixed frame 'sensor' 1 time in /tf_static; each pose holds from "
                              "its recording on"),
        std::string::npos)
        << reading.warnings;
  }
}

TEST_F(BagFramesTest, AFixedFrameThatIsRecordedLateHoldsBeforeToo) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  bag.transform(12.9, "sensor", "tip", mount(), true);
  bag.cloud("/points", 12.2, "tip", {{1, 2, 3}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 5U);
  expect_pose(reading.frames[3], base_at(12.2) * mount() * mount());
}

TEST_F(BagFramesTest, AFrameThatLeadsToNoSensorMayAlternate) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (int i = 0; i < 50; ++i)
    bag.transform(10 + 0.05 * i, "map", "goal", Eigen::Isometry3d(Eigen::Translation3d(0, i % 2, 0)));
  EXPECT_EQ(read(bag, "a.mcap").frames.size(), 4U);
}

TEST_F(BagFramesTest, WhatHasNoPoseAtItsTimeSaysThatAndWhenThereAreSome) {
  const auto warnings = [&](double later, double stamp, const std::string& frame) {
    ScanBag bag(folder_ / "a.mcap");
    bag.transform(later + 10, "base", "sensor", mount(), true);
    bag.transform(later + 10, "other", "loose", mount(), true);
    for (double time = 10; time < 13.001; time += 0.05)
      bag.transform(later + time, "map", "base", base_at(time));
    bag.transform(later + 16, "map", "base", base_at(16));
    bag.cloud("/points", {later + 11.0, stamp}, frame, {{1, 2, 3}});
    bag.sort();
    return read(bag, "a.mcap").warnings;
  };
  const std::string late = warnings(0, 15.5, "sensor");
  EXPECT_NE(
      late.find("'sensor' is not known in 'map' at its time, 15.500 s: transforms of all frames between "
                "the two cover 10.000 to 16.000 s, those of one around it more than 1 s apart"),
      std::string::npos)
      << late;
  EXPECT_EQ(late.find("from when its sensor started"), std::string::npos) << late;
  const std::string since_start = warnings(1.7e9, 1234.0, "sensor");
  EXPECT_NE(
      since_start.find("at its time, 1234.000 s: transforms of all frames between the two cover "
                       "1700000010.000 to 1700000016.000 s, and the message's stamp counts from when its "
                       "sensor started"),
      std::string::npos)
      << since_start;
  const std::string loose = warnings(0, 11.0, "loose");
  EXPECT_NE(loose.find("'loose' is not known in 'map': no chain of transforms joins the two"),
            std::string::npos)
      << loose;
}

TEST_F(BagFramesTest, PosesThatComeAtDifferentTimesAreSaidToHaveNoneTogether) {
  ScanBag bag(folder_ / "a.mcap");
  for (int i = 0; i <= 60; ++i) {
    bag.transform(10 + 0.05 * i, "map", "base", base_at(10 + 0.05 * i));
    bag.transform(20 + 0.05 * i, "base", "sensor", mount());
  }
  bag.cloud("/points", 15, "sensor", {{1, 2, 3}});
  bag.sort();
  const std::string warning = read(bag, "a.mcap").warnings;
  EXPECT_NE(warning.find("transforms of all frames between the two cover no time together: some begin at "
                         "20.000 s, others end at 13.000 s"),
            std::string::npos)
      << warning;
}

/// A bag without tf: where the base is by messages of this type, where the sensor is on it by the setup.
TEST_F(BagFramesTest, PosesOfTheirOwnTopicsCountAsThoseOfTf) {
  for (const char* name : {"a.mcap", "a.bag"}) {
    for (const std::string type : {"nav_msgs/Odometry", "geometry_msgs/TransformStamped",
                                   "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped"}) {
      const bool is_nameless = type.starts_with("geometry_msgs/Pose");
      BagTopics stated;
      stated.poses = {"/where"};
      stated.frames = {{"base", "sensor", mount()}};
      ScanBag bag(folder_ / name);
      for (double time = 10; time < 13.001; time += 0.05)
        bag.pose(type, "/where", time, "map", is_nameless ? "" : "base", base_at(time));
      for (const double time : {10.53, 11.11, 12.41}) bag.cloud("/points", time, "sensor", {{1, 2, 3}});
      bag.transform(9, "base", "sensor", Eigen::Isometry3d::Identity(), true);  // does not count
      bag.sort();
      if (is_nameless) {
        const std::string sentence = complaint([&] { read(bag, name, false, stated); });
        EXPECT_NE(sentence.find("expected 'pose_frame' beside 'poses'"), std::string::npos) << sentence;
        stated.pose_frame = "base";
      }
      for (const bool is_cut : {false, true}) {
        if (is_cut) stated.from = 2.1, stated.to = 2.12;  // 11.11 s, between two poses that are not in it
        const Reading reading = read(bag, name, false, stated);
        EXPECT_EQ(reading.damage + reading.warnings, "") << type;
        ASSERT_EQ(reading.frames.size(), is_cut ? 1U : 3U) << type;
        for (const Frame& frame : reading.frames) {
          const auto& cloud = std::get<CloudFrame>(frame.content);
          EXPECT_LT((cloud.world_from_sensor.matrix() - (base_at(frame.time) * mount()).matrix()).norm(),
                    1e-4)
              << type << " " << frame.time;
        }
      }
    }
  }
}

/// As SLAM publishes it: the whole way again and again, and better each time.
TEST_F(BagFramesTest, TheLastPathOfATopicSaysWhereTheRobotWas) {
  for (const char* name : {"a.mcap", "a.bag"}) {
    BagTopics stated;
    stated.poses = {"/path"};
    stated.frames = {{"base", "sensor", mount()}};
    ScanBag bag(folder_ / name);
    for (const double last : {11.5, 13.0}) {
      std::vector<std::pair<double, Eigen::Isometry3d>> poses;
      const Eigen::Isometry3d drift(Eigen::Translation3d(0.0, last < 12.0 ? 0.3 : 0.0, 0.0));
      for (double time = 10; time < last + 0.001; time += 0.05)
        poses.emplace_back(time, drift * base_at(time));
      bag.path("/path", last, "map", poses);
    }
    for (const double time : {10.53, 11.11, 12.41}) bag.cloud("/points", time, "sensor", {{1, 2, 3}});
    bag.sort();
    EXPECT_NE(complaint([&] { read(bag, name, false, stated); }).find("expected 'pose_frame'"),
              std::string::npos);
    stated.pose_frame = "base";
    const Reading reading = read(bag, name, false, stated);
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 3U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
    bag.path("/path", 13.1, "map", {{0.0, base_at(10)}, {0.0, base_at(11)}});
    EXPECT_NE(
        read(bag, name, false, stated).warnings.find("the poses of its path have no times of their own"),
        std::string::npos);
  }
}

TEST_F(BagFramesTest, APoseThatDoesNotSayOfWhatItIsIsLeftOutAndNamed) {
  ScanBag bag(folder_ / "a.mcap");
  BagTopics stated;
  stated.poses = {"/odom"};
  bag.transform(9, "base", "sensor", mount(), true);
  for (double time = 10; time < 13.001; time += 0.05) bag.transform(time, "map", "base", base_at(time));
  bag.pose("nav_msgs/Odometry", "/odom", 11, "", "base", base_at(11));
  bag.cloud("/points", 11.11, "sensor", {{1, 2, 3}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap", false, stated);
  EXPECT_EQ(reading.frames.size(), 1U);
  EXPECT_NE(reading.warnings.find("its pose does not say what it is of and in which frame"),
            std::string::npos)
      << reading.warnings;
}

}  // namespace bag_frames_poses_test
}  // namespace clearway
