// Sweeps and clouds of sensors that move while they measure, and poses that jump.

#include "datasets/ros/bag_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "tests/datasets/ros/bag_frames_world.hpp"

namespace clearway {
namespace bag_frames_sweep_test {

using namespace bag_frames_world;

/// A base that drives and turns fast.
Eigen::Isometry3d driving_at(double time) {
  return Eigen::Translation3d(1.5 * time - 15, 0.2, 0.3) * Eigen::AngleAxisd(time, Eigen::Vector3d::UnitZ());
}

/// How far a wall at x = 8 m or y = 3 m is along a ray, cast here; 0: there is none.
float range_to_walls(const Eigen::Isometry3d& map_from_laser, double angle) {
  const Eigen::Vector3d origin = map_from_laser.translation();
  const Eigen::Vector3d ray = map_from_laser.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  double nearest = HUGE_VAL;
  if (ray.x() > 0) nearest = std::min(nearest, (8 - origin.x()) / ray.x());
  if (ray.y() > 0) nearest = std::min(nearest, (3 - origin.y()) / ray.y());
  return nearest < 25 ? static_cast<float>(nearest) : std::numeric_limits<float>::infinity();
}

Eigen::Isometry3d mount_flat() { return Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0.25)); }

constexpr int rays = 360;
const worlds::BagSweep turn{-3.0F, 6.0F / rays, 0.1F / rays};

/// Sweeps from 10 s on, every second one beginning at the last ray, with the base's poses until `end`.
void add_sweeps(ScanBag& bag, double end, const std::vector<double>& times, float direction) {
  const Eigen::Isometry3d laser(Eigen::Translation3d(0.1, 0, 0.25));
  bag.transform(9, "base", "laser", laser, true);
  for (double time = 9.5; time < end; time += 0.02) bag.transform(time, "map", "base", driving_at(time));
  worlds::BagSweep sweep = turn;
  sweep.time_increment *= direction;
  for (const double time : times) {
    std::vector<float> ranges;
    for (int ray = 0; ray < rays; ++ray) {
      const double at = time + ray * double{sweep.time_increment};
      ranges.push_back(range_to_walls(driving_at(at) * laser,
                                      double{turn.angle_min} + ray * double{turn.angle_increment}));
    }
    bag.sweep("/scan", time, "laser", sweep, ranges);
  }
  bag.sort();
}

TEST_F(BagFramesTest, EachRayOfASweepIsWhereTheLaserWasThen) {
  for (const float direction : {1.0F, -1.0F}) {
    for (const char* name : {"sweep.mcap", "sweep.bag"}) {
      ScanBag bag(folder_ / name);
      add_sweeps(bag, 12, {10.0, 10.5, 11.0}, direction);
      const Reading reading = read(bag, name);
      EXPECT_EQ(reading.damage + reading.warnings, "");
      std::size_t points = 0;
      double before = 0.0;
      for (const Frame& frame : reading.frames) {
        const auto& cloud = std::get<CloudFrame>(frame.content);
        EXPECT_GE(frame.time, before);
        before = frame.time;
        const Eigen::Vector3d origin = cloud.world_from_sensor.translation();
        const Eigen::Vector3d then =
            driving_at(frame.time) * Eigen::Vector3d(0.1, 0, 0.25);  // at its first ray
        EXPECT_LT((origin - then).norm(), 0.0126 + 1e-3) << "within a quarter voxel";
        ASSERT_EQ(cloud.times.size(), cloud.points.size());
        for (std::size_t i = 0; i < cloud.points.size(); ++i) {
          const Eigen::Vector3d place = cloud.world_from_sensor * cloud.points[i].cast<double>();
          EXPECT_LT(std::min(std::abs(place.x() - 8), std::abs(place.y() - 3)), 1e-3) << place.transpose();
          const Eigen::Vector3d laser =
              driving_at(frame.time + static_cast<double>(cloud.times[i])) * Eigen::Vector3d(0.1, 0, 0.25);
          EXPECT_LT((origin - laser).norm(), 0.0126 + 1e-3) << "when the ray was out";
          ++points;
        }
      }
      EXPECT_GT(reading.frames.size(), 20U) << "15 cm of way each, a third of it without a wall";
      EXPECT_GT(points, 500U);
    }
  }
}

TEST_F(BagFramesTest, BeamsThatMetNothingReachTheRangeFromWhereTheLaserWasThen) {
  for (const float direction : {1.0F, -1.0F}) {
    ScanBag bag(folder_ / "sweep.mcap");
    add_sweeps(bag, 12, {10.0, 10.5}, direction);
    const Reading plain = read(bag, "sweep.mcap"), clear = read(bag, "sweep.mcap", true);
    std::size_t beams = 0, points = 0, ends = 0, hits = 0, unclear = 0;
    for (const Frame& frame : plain.frames) {
      const auto& cloud = std::get<CloudFrame>(frame.content);
      points += cloud.points.size();
      beams += cloud.infinite;
      unclear += cloud.clear_to.size();
    }
    EXPECT_EQ(unclear, 0U);
    EXPECT_EQ(points + beams, 2U * rays);
    EXPECT_GT(beams, 100U);
    std::size_t counted = 0;
    for (const Frame& frame : clear.frames) {
      const auto& cloud = std::get<CloudFrame>(frame.content);
      hits += cloud.points.size();
      ends += cloud.clear_to.size();
      counted += cloud.infinite;
      for (const Eigen::Vector3f& end : cloud.clear_to)  // within a quarter voxel of that place
        EXPECT_NEAR(double{end.norm()}, 30.0, 0.0126 + 1e-3);
    }
    EXPECT_EQ(hits, points);
    EXPECT_EQ(ends, beams);
    EXPECT_EQ(counted, beams);
  }
}

TEST_F(BagFramesTest, ASweepOfALaserThatStandsIsOneFrame) {
  for (const float increment : {0.0F, turn.time_increment}) {
    ScanBag bag(folder_ / "sweep.mcap");
    bag.transform(9, "map", "laser", mount(), true);
    worlds::BagSweep sweep = turn;
    sweep.time_increment = increment;
    bag.sweep("/scan", 10, "laser", sweep, std::vector<float>(rays, 2.5F));
    const Reading reading = read(bag, "sweep.mcap");
    ASSERT_EQ(reading.frames.size(), 1U);
    EXPECT_EQ(reading.frames[0].time, 10);
    const auto& cloud = std::get<CloudFrame>(reading.frames[0].content);
    ASSERT_EQ(cloud.points.size(), static_cast<std::size_t>(rays));
    ASSERT_EQ(cloud.times.size(), increment == 0.0F ? 0U : cloud.points.size());
    for (std::size_t i = 0; i < cloud.times.size(); ++i)
      EXPECT_EQ(cloud.times[i], increment * static_cast<float>(i));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const double angle = double{turn.angle_min} + static_cast<double>(i) * double{turn.angle_increment};
      EXPECT_EQ(cloud.points[i], Eigen::Vector3f(static_cast<float>(2.5 * std::cos(angle)),
                                                 static_cast<float>(2.5 * std::sin(angle)), 0));
    }
  }
}

TEST_F(BagFramesTest, ASweepWhoseEndHasNoPoseIsLeftOutAndCounted) {
  ScanBag bag(folder_ / "sweep.mcap");
  add_sweeps(bag, 10.57, {10.0, 10.5}, 1.0F);
  const Reading reading = read(bag, "sweep.mcap");
  ASSERT_FALSE(reading.frames.empty());
  EXPECT_LT(reading.frames.back().time, 10.2);
  EXPECT_NE(
      reading.warnings.find("holds 1 message in topic '/scan' that cannot be used: frame 'laser' is not "
                            "known in 'map' at its time"),
      std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, WhileAPoseJumpsScansAreLeftOutAndOnlyThen) {
  const Eigen::Isometry3d jump =
      Eigen::Translation3d(0.8, -0.5, 0) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  ScanBag bag(folder_ / "a.mcap");
  for (double time = 9.9; time < 13.001; time += 0.025) bag.transform(time, "odom", "base", driving_at(time));
  const auto map_from_odom = [&](double time) { return time < 11.49 ? Eigen::Isometry3d::Identity() : jump; };
  for (double time = 9.75; time < 13.3; time += 0.25) bag.transform(time, "map", "odom", map_from_odom(time));
  std::size_t outside = 0;
  for (double time = 10.01; time < 13; time += 0.04) {
    bag.cloud("/points", time, "base", {{1, 2, 3}});
    outside += time < 11.25 || time > 11.5 ? 1 : 0;
  }
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage, "");
  ASSERT_EQ(reading.frames.size(), outside);
  for (const Frame& frame : reading.frames)
    EXPECT_LT((std::get<CloudFrame>(frame.content).world_from_sensor.translation() -
               (map_from_odom(frame.time) * driving_at(frame.time)).translation())
                  .norm(),
              2e-3);
  EXPECT_NE(reading.warnings.find("holds 6 messages in topic '/points' at times at which a pose jumps, which "
                                  "were left out; of the first, frame 'odom' jumps by 0.943"),
            std::string::npos)
      << reading.warnings;
  EXPECT_NE(reading.warnings.find("between 11.250 and 11.500 s"), std::string::npos) << reading.warnings;
}

TEST_F(BagFramesTest, ARobotThatStartsStopsAndTurnsHardDoesNotJump) {
  const auto place = [](double time) {  // to 4 m/s within 0.5 s, and back; turns of up to 6 rad/s
    const double since = std::clamp(time - 11, 0.0, 1.0);  // at 8 m/s^2
    const double way = since < 0.5 ? 4 * since * since : 2 - 4 * (1 - since) * (1 - since);
    return Eigen::Translation3d(way, 0, 0) *
           Eigen::AngleAxisd(3.0 * std::sin(2.0 * time), Eigen::Vector3d::UnitZ());
  };
  for (const double step : {0.02, 0.1, 0.25}) {
    ScanBag bag(folder_ / "a.mcap");
    for (double time = 10; time < 13.001; time += step)
      bag.transform(time, "map", "base", Eigen::Isometry3d(place(time)));
    std::size_t scans = 0;
    for (double time = 10.01; time < 12.7; time += 0.07, ++scans)
      bag.cloud("/points", time, "base", {{1, 2, 3}});
    bag.sort();
    const Reading reading = read(bag, "a.mcap");
    EXPECT_EQ(reading.frames.size(), scans) << step << reading.warnings;
  }
}

/// Scans of a sensor on a base that drives, put into another frame; `odom` is where odometry begins.
void add_registered(ScanBag& bag, const std::string& frame) {
  const Eigen::Isometry3d map_from_odom(Eigen::Translation3d(3, -2, 0));
  bag.transform(9, "base", "sensor", mount(), true);
  for (double time = 9.9; time < 12.001; time += 0.1) {
    bag.transform(time, "odom", "base", map_from_odom.inverse() * driving_at(time));
    bag.transform(time, "map", "odom", map_from_odom);
    bag.transform(time, "base", "wheel",
                  Eigen::Isometry3d(Eigen::AngleAxisd(time, Eigen::Vector3d::UnitY())));
  }
  const Eigen::Isometry3d frame_from_map =
      frame == "odom" ? map_from_odom.inverse() : Eigen::Isometry3d::Identity();
  for (const double time : {10.0, 10.5, 11.0})
    bag.cloud("/points", time, frame, {(frame_from_map * Eigen::Vector3d(4, 2.5, 1)).cast<float>()});
  bag.sort();
}

TEST_F(BagFramesTest, CloudsInAFrameInWhichTheSensorDrivesHaveNoOriginUntilItIsNamed) {
  for (const char* frame : {"map", "odom"}) {
    ScanBag bag(folder_ / "a.mcap");
    add_registered(bag, frame);
    const Reading unknown = read(bag, "a.mcap");
    BagTopics named;
    named.sensor_frame = "sensor";
    const Reading known = read(bag, "a.mcap", false, named);
    ASSERT_EQ(unknown.frames.size(), 3U) << unknown.damage;
    ASSERT_EQ(known.frames.size(), 3U) << known.damage;
    EXPECT_EQ(known.damage + known.warnings, "");
    EXPECT_NE(unknown.warnings.find(std::string("holds 3 clouds in topic '/points' in frame '") + frame +
                                    "', which is no sensor's: they mark what is occupied and free nothing"),
              std::string::npos)
        << unknown.warnings;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& without = std::get<CloudFrame>(unknown.frames[i].content);
      const auto& with = std::get<CloudFrame>(known.frames[i].content);
      EXPECT_FALSE(without.is_origin_known);
      EXPECT_TRUE(with.is_origin_known);
      expect_pose(known.frames[i], driving_at(known.frames[i].time) * mount());
      for (const CloudFrame* cloud : {&without, &with})
        EXPECT_LT((cloud->world_from_sensor * cloud->points.at(0).cast<double>() - Eigen::Vector3d(4, 2.5, 1))
                      .norm(),
                  1e-5);
    }
  }
}

/// As FAST-LIO and others publish them; the bag has no transforms.
TEST_F(BagFramesTest, CloudsInAFrameOfTheWorldHaveNoOriginWithoutTransformsEither) {
  for (const auto& [frame, odometry, is_sensors] :
       std::vector<std::tuple<std::string, std::string, bool>>{{"map", "", true},
                                                               {"map", "odom", false},
                                                               {"odom", "", false},
                                                               {"camera_init", "", false},
                                                               {"camera_init", "camera_init", false},
                                                               {"start", "start", false},
                                                               {"start", "", true},
                                                               {"lidar", "start", true}}) {
    ScanBag bag(folder_ / "a.mcap");
    if (!odometry.empty())
      for (double time = 9.9; time < 12.001; time += 0.1)
        bag.pose("nav_msgs/Odometry", "/Odometry", time, odometry, "body", driving_at(time));
    bag.cloud("/points", 11.0, frame, {{4, 2.5, 1}});
    bag.sort();
    BagTopics fixed;
    fixed.fixed_frame = frame;
    const Reading reading = read(bag, "a.mcap", false, fixed);
    ASSERT_EQ(reading.frames.size(), 1U) << frame << reading.damage;
    EXPECT_EQ(std::get<CloudFrame>(reading.frames[0].content).is_origin_known, is_sensors)
        << frame << odometry;
    EXPECT_EQ(reading.warnings.find("free nothing") == std::string::npos, is_sensors) << reading.warnings;
    EXPECT_EQ(reading.warnings.find("is taken to stand at that frame's origin") != std::string::npos,
              is_sensors && frame == "map")
        << reading.warnings;
    fixed.sensor_frame = frame;
    const Reading named = read(bag, "a.mcap", false, fixed);
    EXPECT_TRUE(std::get<CloudFrame>(named.frames.at(0).content).is_origin_known) << frame << odometry;
  }
}

TEST_F(BagFramesTest, CloudsOfASensorThatStandsOrIsDrivenHaveTheOriginOfTheirFrame) {
  ScanBag bag(folder_ / "a.mcap");
  add_registered(bag, "sensor");  // above it a wheel turns
  bag.transform(9, "map", "pole", mount(), true);
  bag.cloud("/points", 11.2, "pole", {{1, 2, 3}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 4U);
  for (const Frame& frame : reading.frames) EXPECT_TRUE(std::get<CloudFrame>(frame.content).is_origin_known);
}

/// A cloud of rays that go out one after the other while the base drives, in steps of `unit` s before the
/// stamp or after it; how far the walls are is cast here.
void add_timed_cloud(ScanBag& bag, double stamp, double begin, double unit) {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> times;
  for (int ray = 0; ray < 2 * rays; ++ray) {
    const double angle = 6.0 * (ray / 2) / rays - 3.0, since = begin + 0.1 * (ray / 2) / rays;
    const float range = range_to_walls(driving_at(stamp + since) * mount_flat(), angle);
    if (!std::isfinite(range)) continue;
    points.emplace_back(range * static_cast<float>(std::cos(angle)),
                        range * static_cast<float>(std::sin(angle)), ray % 2 == 0 ? 0.0F : 0.5F);
    times.push_back(static_cast<float>(since / unit));
  }
  bag.cloud("/points", stamp, "sensor", points, "time", times);
}

TEST_F(BagFramesTest, EachPointOfACloudIsWhereTheSensorWasThenInAnyUnit) {
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
    for (const double begin : {0.0, -0.1, -0.05}) {
      ScanBag bag(folder_ / "a.mcap");
      bag.transform(9, "base", "sensor", mount_flat(), true);
      for (double time = 9; time < 12; time += 0.02) bag.transform(time, "map", "base", driving_at(time));
      for (const double stamp : {10.0, 10.5}) add_timed_cloud(bag, stamp, begin, unit);
      bag.sort();
      const Reading reading = read(bag, "a.mcap");
      EXPECT_EQ(reading.damage, "");
      EXPECT_NE(reading.warnings.find("holds 2 clouds in topic '/points' during which the sensor moved"),
                std::string::npos)
          << reading.warnings;
      EXPECT_NE(reading.warnings.find("by the field 'time'"), std::string::npos) << reading.warnings;
      std::size_t points = 0;
      for (const Frame& frame : reading.frames) {
        const auto& cloud = std::get<CloudFrame>(frame.content);
        EXPECT_LT(
            (cloud.world_from_sensor.translation() - (driving_at(frame.time) * mount_flat()).translation())
                .norm(),
            0.0126 + 1e-3)
            << "within a quarter voxel";
        for (const Eigen::Vector3f& point : cloud.points) {
          const Eigen::Vector3d place = cloud.world_from_sensor * point.cast<double>();
          EXPECT_LT(std::min(std::abs(place.x() - 8), std::abs(place.y() - 3)), 2e-3) << place.transpose();
          ++points;
        }
      }
      EXPECT_GT(points, 700U);
      BagTopics stamped;
      stamped.point_times = false;
      const Reading plain = read(bag, "a.mcap", false, stamped);
      EXPECT_EQ(plain.frames.size(), 2U);
      EXPECT_NE(plain.warnings.find("each is placed by one pose, at its stamp"), std::string::npos);
    }
}

/// A robot may move in front of a sensor that stands: clouds say when each point was seen where one is.
TEST_F(BagFramesTest, CloudsBesideARobotKeepTheTimesOfTheirPoints) {
  ScanBag bag(folder_ / "a.mcap");
  bag.transform(9, "map", "sensor", mount_flat(), true);
  bag.cloud("/points", 10.0, "sensor", {{3, 0, 1}, {0, 0, 0}, {2, 1, 1}, {2, 2, 1}}, "time",
            {0.0F, 0.01F, 0.04F, 0.09F});
  bag.sort();
  const auto times = [&](const char* base, bool point_times) {
    BagTopics topics;
    topics.robot_base = base;
    topics.point_times = point_times;
    const Reading reading = read(bag, "a.mcap", false, topics);
    EXPECT_EQ(reading.frames.size(), 1U) << reading.damage;
    return std::get<CloudFrame>(reading.frames.at(0).content).times;
  };
  EXPECT_EQ(times("robot", true), (std::vector<float>{0.0F, 0.04F, 0.09F}));  // what is at the origin is none
  EXPECT_TRUE(times("", true).empty());
  EXPECT_TRUE(times("robot", false).empty());
}

TEST_F(BagFramesTest, EachPointOfALivoxCloudIsWhereTheSensorWasThen) {
  for (const char* name : {"livox.mcap", "livox.bag"}) {
    ScanBag bag(folder_ / name);
    bag.transform(9, "base", "sensor", mount_flat(), true);
    for (double time = 9.5; time < 12; time += 0.02) bag.transform(time, "map", "base", driving_at(time));
    std::size_t sent = 0;
    for (const double stamp : {10.0, 10.5}) {
      std::vector<Eigen::Vector3f> points{{0, 0, 0}};  // nothing came back
      std::vector<std::uint32_t> times{0};
      for (int ray = 0; ray < rays; ++ray) {
        const double angle = 6.0 * ray / rays - 3.0;
        const auto since = static_cast<std::uint32_t>(1e8 * ray / rays);
        const float range = range_to_walls(driving_at(stamp + 1e-9 * since) * mount_flat(), angle);
        if (!std::isfinite(range)) continue;
        points.emplace_back(range * static_cast<float>(std::cos(angle)),
                            range * static_cast<float>(std::sin(angle)), 0.0F);
        times.push_back(since);
        ++sent;
      }
      bag.livox("/points", stamp, "sensor", points, times);
    }
    bag.sort();
    const Reading reading = read(bag, name);
    EXPECT_EQ(reading.damage, "");
    std::size_t points = 0;
    for (const Frame& frame : reading.frames) {
      const auto& cloud = std::get<CloudFrame>(frame.content);
      points += cloud.points.size();
      for (const Eigen::Vector3f& point : cloud.points) {
        const Eigen::Vector3d place = cloud.world_from_sensor * point.cast<double>();
        EXPECT_LT(std::min(std::abs(place.x() - 8), std::abs(place.y() - 3)), 1e-3) << place.transpose();
      }
    }
    EXPECT_EQ(points, sent);
    EXPECT_GT(sent, 300U);
    EXPECT_GT(reading.frames.size(), 10U);
    for (const std::size_t cut : {0U, 1U, 8U}) {
      ScanBag last(folder_ / name);
      last.transform(9, "map", "sensor", mount_flat(), true);
      last.livox("/points", 10, "sensor", {{1, 2, 3}, {4, 5, 6}}, {0, 1});
      last.cut_last(cut);
      EXPECT_EQ(read(last, name).damage.empty(), cut == 0) << cut;
    }
  }
}

TEST_F(BagFramesTest, CloudsOfASensorThatStandsAreOneFrameAndOddTimesAreTold) {
  const std::vector<Eigen::Vector3f> points{{1, 0, 0}, {0, 2, 0}, {3, 0, 0}};
  for (const bool are_odd : {false, true}) {
    ScanBag bag(folder_ / "a.mcap");
    for (double time = 9; time < 12; time += 0.02)
      bag.transform(time, "map", "base", are_odd ? driving_at(time) : base_at(0));
    const float scale = are_odd ? 3e4F : 1.0F;  // 3000 s, or 3 s in thousandths: no sweep in any unit
    bag.cloud("/points", 10, "base", points, "time", {-0.1F * scale, -0.05F * scale, 0.0F});
    bag.cloud("/points", 11, "base", points);
    bag.sort();
    const Reading reading = read(bag, "a.mcap");
    ASSERT_EQ(reading.frames.size(), 2U) << reading.damage;
    EXPECT_EQ(std::get<CloudFrame>(reading.frames[0].content).points, points);
    const bool is_told = reading.warnings.find(
                             "holds 1 cloud in topic '/points' whose points' times make no "
                             "sense in s, ms, us or ns since the stamp or 1970 (of the "
                             "first, 'time' spans 3000)") != std::string::npos;
    EXPECT_EQ(is_told, are_odd) << reading.warnings;
  }
}

}  // namespace bag_frames_sweep_test
}  // namespace clearway
