#include "datasets/poses/pose_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "datasets/poses/tum_poses.hpp"

namespace clearway {
namespace pose_stream_test {

/// A screw about z: half a turn and 2 m a second.
Eigen::Isometry3d screw(double time) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(M_PI / 2 * time, Eigen::Vector3d::UnitZ()));
  pose.translation() = Eigen::Vector3d(1.0, 2.0 * time, -0.5);
  return pose;
}

double apart(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).norm();
}

TEST(PoseStream, BetweenReadingsThePoseIsOnTheStraightLineAndTheShortestTurn) {
  PoseStream stream(0.25);
  const double start = 1577836800.0;  // as clocks give it
  for (int i = 10; i >= 0; --i) stream.add(start + 0.1 * i, screw(0.1 * i));
  for (double time = 0.0; time <= 1.0; time += 0.013) {
    const auto pose = stream.at(start + time);
    ASSERT_TRUE(pose);
    EXPECT_LT(apart(*pose, screw(time)), 1e-5) << time;
  }
}

TEST(PoseStream, TheNearestPoseIsThatBeforeOrThatAfter) {
  PoseStream stream(0.5);
  for (const double time : {1.0, 1.3, 2.0}) stream.add(time, screw(time));
  for (const auto& [asked, time] :
       {std::pair(0.6, 1.0), {1.0, 1.0}, {1.14, 1.0}, {1.16, 1.3}, {1.6, 1.3}, {1.7, 2.0}, {2.4, 2.0}}) {
    ASSERT_TRUE(stream.nearest(asked)) << asked;
    EXPECT_TRUE(stream.nearest(asked)->isApprox(screw(time), 1e-9)) << asked;
  }
}

TEST(PoseStream, OutsideOfItsTimeAndAcrossGapsItSaysNothing) {
  PoseStream stream(0.25);
  EXPECT_FALSE(stream.at(5.0));
  EXPECT_FALSE(stream.nearest(5.0));
  for (const double time : {5.0, 5.2, 6.0}) stream.add(time, screw(time));
  EXPECT_FALSE(stream.at(4.999));
  EXPECT_TRUE(stream.at(5.0));
  EXPECT_TRUE(stream.at(5.1));
  EXPECT_FALSE(stream.at(5.5));
  EXPECT_TRUE(stream.at(6.0));
  EXPECT_FALSE(stream.at(6.001));
  EXPECT_FALSE(stream.at(NAN));
  EXPECT_LT(apart(*stream.nearest(5.11), screw(5.2)), 1e-6);
  EXPECT_LT(apart(*stream.nearest(6.2), screw(6.0)), 1e-6);
  EXPECT_FALSE(stream.nearest(6.3));
  PoseStream one(1e11);  // of gaps too: longer than any clock has run
  one.add(5.0, screw(5.0));
  EXPECT_FALSE(one.at(4.9) || one.at(5.1));
  EXPECT_LT(apart(*one.at(5.0), screw(5.0)), 1e-12);
  PoseStream two(2.0);
  for (const double time : {1.0, 2.0}) two.add(time, screw(time));
  EXPECT_LT(apart(*two.nearest(1.5), screw(2.0)), 1e-6);  // of two as near the later
  EXPECT_NEAR(*stream.last_time(), 6.0, 1e-6);
}

TEST(PoseStream, InAGapThatIsTooLongItSaysNothingHoweverNearAReadingIs) {
  PoseStream stream(0.25);
  for (const double time : {5.0, 5.24, 5.5, 6.5}) stream.add(time, screw(time));
  for (double time = 5.005; time < 6.5; time += 0.01)  // never a reading's own
    EXPECT_EQ(stream.at(time).has_value(), time < 5.24) << time;
  EXPECT_TRUE(stream.at(5.5) && stream.at(6.5));
  for (const double time : {5.2401, 5.2501, 5.4999, 5.5001, 5.6, 6.4, 6.4999})
    EXPECT_FALSE(stream.at(time)) << time;
}

TEST(PoseStream, NamesTheTimesOfTheReadingsAroundATime) {
  PoseStream stream(0.25);
  const auto expect = [&](double time, std::optional<double> before, std::optional<double> after) {
    const PoseStream::Around around = stream.around(time);
    EXPECT_EQ(around.before, before) << time;
    EXPECT_EQ(around.after, after) << time;
  };
  expect(5.0, {}, {});
  for (const double time : {5.0, 5.5, 8.0}) stream.add(time, screw(time));
  expect(4.5, {}, 5.0);
  expect(5.0, 5.0, 5.0);
  expect(5.25, 5.0, 5.5);
  expect(5.5, 5.5, 5.5);
  expect(7.0, 5.5, 8.0);  // across a gap, too
  expect(8.0, 8.0, 8.0);
  expect(9.0, 8.0, {});
  expect(NAN, {}, {});
}

/// A loop that closes: 12.9 m in a tenth of a second between two steady walks.
TEST(PoseStream, WithinAJumpItSaysNothingAndTellsOfIt) {
  const auto walk = [](double time, double shift) {
    return Eigen::Isometry3d(Eigen::Translation3d(0.5 * time + shift, 0.0, 1.0));
  };
  for (const double per_second : {10.0, 2.0}) {
    PoseStream stream(0.6);
    for (int i = 0; i < 20; ++i) stream.add(i / per_second, walk(i / per_second, i < 10 ? 0.0 : 12.9));
    EXPECT_TRUE(stream.at(9.5 / per_second));  // nobody asked for it
    stream.leave_out_jumps();
    for (const double at : {0.5, 8.5, 9.0, 10.0, 10.5, 18.5}) {
      EXPECT_TRUE(stream.at(at / per_second)) << at;
      EXPECT_TRUE(stream.nearest(at / per_second)) << at;
      EXPECT_FALSE(stream.is_in_jump(at / per_second)) << at;
    }
    EXPECT_FALSE(stream.at(9.5 / per_second));
    EXPECT_FALSE(stream.nearest(9.2 / per_second));
    ASSERT_EQ(stream.jumps().size(), 1U);
    EXPECT_NEAR(stream.jumps()[0].shift, 12.9 + 0.5 / per_second, 1e-6);
    EXPECT_NEAR(stream.jumps()[0].before, 9.0 / per_second, 1e-6);
    const auto told = jumping_poses("walk.txt", stream);
    ASSERT_TRUE(told);
    EXPECT_NE(told->find("'walk.txt' jump once by 13"), std::string::npos) << *told;
  }
}

TEST(PoseStream, ATurnInAnInstantIsAJumpToo) {
  PoseStream stream(0.5);
  for (int i = 0; i < 20; ++i)
    stream.add(0.1 * i, Eigen::Isometry3d(
                            Eigen::AngleAxisd(0.05 * i + (i < 10 ? 0.0 : 1.5), Eigen::Vector3d::UnitZ())));
  stream.leave_out_jumps();
  ASSERT_EQ(stream.jumps().size(), 1U);
  EXPECT_NEAR(stream.jumps()[0].turn, 1.55, 1e-6);
}

/// What logs of robots have: poses twice, stale ones, noise, stops, turns in place, stamps that jitter.
TEST(PoseStream, HonestPosesDoNotJump) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto expect_none = [](const char* what, const auto& time_of, const auto& pose_of) {
    PoseStream stream(1.5);
    for (int i = 0; i < 400; ++i) stream.add(time_of(i), pose_of(i));
    stream.leave_out_jumps();
    EXPECT_TRUE(stream.jumps().empty()) << what << " " << stream.jumps().size();
  };
  const auto along = [](double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.0)); };
  const auto turned = [](double angle) {
    return Eigen::Isometry3d(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  };
  const auto twentieth = [](int i) { return 0.05 * i; };
  const auto tenth = [](int i) { return 0.1 * i; };
  expect_none("each twice", twentieth, [&](int i) { return along(0.15 * (i / 2)); });
  expect_none("each twice, fast", twentieth, [&](int i) { return along(1.0 * (i / 2)); });
  expect_none("turning, each twice", twentieth, [&](int i) { return turned(0.2 * (i / 2)); });
  expect_none("one in ten stale", tenth, [&](int i) { return along(0.15 * (i - (i % 10 == 9))); });
  expect_none("noise", tenth, [&](int i) { return along(0.1 * i + 0.05 * normal(random)); });
  expect_none("GPS", tenth, [&](int i) { return along(0.1 * i + 0.3 * normal(random)); });
  expect_none(
      "stop and go", [](int i) { return 1.0 * i; }, [&](int i) { return along(3.0 * (i / 5)); });
  expect_none("standing", tenth, [&](int) { return along(0.0); });
  double time = 0.0;
  expect_none(
      "stamps", [&](int i) { return time = 0.1 * i + 0.015 * std::sin(i); },
      [&](int i) { return along(1.5 * i); });
}

/// There and back, so that the way from the start says nothing of the speed.
TEST(PoseStream, TheUsualSpeedIsTheMiddleOneOfStepsBetweenPosesThatDiffer) {
  const auto along = [](double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.0)); };
  for (const int repeats : {1, 2, 3}) {  // some logs repeat a pose, which is no stop
    PoseStream stream(1.5);
    for (int i = 0; i < 12 * repeats; ++i) stream.add(0.1 * i / repeats, along(0.2 * (i / repeats % 2)));
    ASSERT_TRUE(stream.usual_speed());
    EXPECT_NEAR(*stream.usual_speed(), 2.0, 1e-4) << repeats;
  }
  PoseStream stream(1.5);
  double at = 0.0;
  for (const double speed : {0.0, 0.7, 0.1, 40.0, 0.3}) {
    stream.add(static_cast<double>(stream.size()), along(at += speed));
    EXPECT_FALSE(stream.usual_speed()) << "four steps are too few";
  }
  stream.add(5.0, along(at + 0.5));
  ASSERT_TRUE(stream.usual_speed());
  EXPECT_NEAR(*stream.usual_speed(), 0.5, 1e-6);
}

}  // namespace pose_stream_test
}  // namespace clearway
