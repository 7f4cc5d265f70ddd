#include "datasets/sources/pose_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "tests/datasets/complaint.hpp"

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

TEST(PoseStream, ReadsEurocsGroundTruth) {
  const std::string head =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1]\n";
  const std::string line = "1403636580838555648,4.5,-1.5,0.75,0.8,0,0,0.6,0.1,0.2,0.3,9";
  const PoseStream poses = parse_tum_poses(head + line + "\n", "p", 1.0);
  ASSERT_EQ(poses.size(), 1U);
  const auto pose = poses.at(poses.first_time().value());
  const Eigen::Isometry3d expected =
      Eigen::Translation3d(4.5, -1.5, 0.75) * Eigen::Quaterniond(0.8, 0, 0, 0.6);
  EXPECT_TRUE(pose && pose->isApprox(expected, 1e-6));
  EXPECT_NEAR(poses.first_time().value(), 1403636580.838555648, 1e-6);
  EXPECT_THROW(parse_tum_poses(head + line + ",7\n", "p", 1.0), std::invalid_argument);
  EXPECT_THROW(parse_tum_poses(line + "\n", "p", 1.0), std::invalid_argument);
}

TEST(PoseStream, ReadsNewerCollegesSecondsAndNanoseconds) {
  for (const auto& [head, counter, more] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"#sec,nsec,x,y,z,qx,qy,qz,qw\n", "", ""},
           {"# counter, sec, nsec, x, y, z, qx, qy, qz, qw\n", "4,", ""},
           {"sec,nsec,x,y,z,qx,qy,qz,qw,error\n", "", ",7"}}) {
    std::size_t left_out = 0;
    const std::string cut = counter + "1583836594,0,1";
    const PoseStream poses =
        parse_tum_poses(head + counter + "1583836591,182590976,1,2,3,0,0,0.6,0.8" + more + "\n" + counter +
                            "1583836592,082590976,2,2,3,0,0,0.6,0.8" + more + "\n" + cut,
                        "p", 1.0, &left_out);
    ASSERT_EQ(poses.size(), 2U) << head;
    EXPECT_EQ(left_out, 1U);
    EXPECT_NEAR(poses.first_time().value(), 1583836591.182590976, 1e-6);
    EXPECT_NEAR(poses.last_time().value(), 1583836592.082590976, 1e-6);
    const Eigen::Isometry3d expected = Eigen::Translation3d(1.5, 2, 3) * Eigen::Quaterniond(0.8, 0, 0, 0.6);
    EXPECT_TRUE(poses.at(1583836591.632590976).value().isApprox(expected, 1e-5)) << head;
    for (const char* wrong : {"1583836591,1e9,", "1583836591,-1,", "1583836591,"})
      EXPECT_THROW(parse_tum_poses(head + counter + wrong + "1,2,3,0,0,0.6,0.8" + more + "\n", "p", 1.0),
                   std::invalid_argument)
          << head << wrong;
  }
}

/// A walk at 0.8 m/s, ten poses a second, also where it stands still for most of the time.
TEST(PoseStream, ThatCanHardlyBeMetresIsTold) {
  const auto walk = [](double unit, int steps, int standing) {
    std::string text;
    for (int i = 0; i < steps + standing; ++i)
      text += std::to_string(1700000000 + i / 10) + "." + std::to_string(i % 10) + " " +
              std::to_string(0.08 * unit * std::min(i, steps)) + " 0 0 0 0 0 1\n";
    return too_fast_poses("walk.txt", parse_tum_poses(text, "p", 1.0));
  };
  EXPECT_FALSE(walk(1.0, 20, 0));
  EXPECT_EQ(
      walk(1000.0, 20, 0),
      "poses 'walk.txt' usually move at 800 m/s from line to line, which are hardly metres and seconds: "
      "expected metres, not millimetres");
  EXPECT_TRUE(walk(1000.0, 20, 100));
  EXPECT_FALSE(walk(1.0, 20, 100));
  EXPECT_FALSE(walk(1000.0, 3, 0));  // too few to say so
}

TEST(PoseStream, ReadsTheTumFormat) {
  const PoseStream stream = parse_tum_poses(
      "# time x y z qx qy qz qw\n1.0 1 2 3 0 0 0 1\n\n1.2 1 2 5 0 0 0.70710678 0.70710678  # turned\n", "t",
      1.0);
  EXPECT_EQ(stream.size(), 2U);
  const auto middle = stream.at(1.1);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->translation().z(), 4.0, 1e-5);
  EXPECT_NEAR(Eigen::AngleAxisd(middle->rotation()).angle(), M_PI / 4, 1e-5);
}

TEST(PoseStream, AHeadSaysTheOrderOfTheQuaternionAndNanosecondsAreTimes) {
  for (const char* head :
       {"# timestamp tx ty tz qw qx qy qz\n",
        "#timestamp, p_x [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n", "# time x y z w x y z\n",
        "# time,pos.x,pos.y,pos.z,rot.w,rot.x,rot.y,rot.z\n",
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
        "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1]\n",
        "timestamp tx ty tz qw qx qy qz\n", "# t, x, y, z, w, i, j, k\n", "t,x,y,z,qw,qi,qj,qk\n",
        "t x y z quat.w quat.i quat.j quat.k\n"}) {
    const PoseStream stream = parse_tum_poses(std::string(head) + "1 1 2 3 0.5 0.1 -0.7 0.5\n", "t", 1.0);
    const Eigen::Quaterniond turn(stream.at(1.0)->rotation());
    EXPECT_LT(turn.angularDistance(Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5).normalized()), 1e-9) << head;
  }
  const PoseStream usual =
      parse_tum_poses("# timestamp tx ty tz qx qy qz qw\n1 1 2 3 0.1 -0.7 0.5 0.5\n", "t", 1.0);
  EXPECT_LT(Eigen::Quaterniond(usual.at(1.0)->rotation())
                .angularDistance(Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5).normalized()),
            1e-9);
  for (const char* head : {"# w is what was lost on the way\n", "# by z and x\n", "# time x y z x y z w\n"}) {
    const PoseStream stream = parse_tum_poses(std::string(head) + "1 1 2 3 0.1 -0.7 0.5 0.5\n", "t", 1.0);
    EXPECT_LT(Eigen::Quaterniond(stream.at(1.0)->rotation())
                  .angularDistance(Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5).normalized()),
              1e-9);
  }
  for (const char* head :
       {"# time x[mm] y[mm] z[mm] qx qy qz qw\n", "# t qw qx qy qz x y y\n", "# t x y z w z y x\n",
        "# t qw qx qy x y z\n", "# t x y z qw q1 q2 q3\n", "# time x (cm) y (cm) z (cm) qw qx qy qz\n"})
    EXPECT_THROW(parse_tum_poses(std::string(head) + "1 1 2 3 0.5 0.5 0.5 0.5\n", "t", 1.0),
                 std::invalid_argument)
        << head;
  const PoseStream stream = parse_tum_poses(
      "1403636579763555584.000000 0 0 0 0 0 0 1\n1403636579863555584.000000 1 0 0 0 0 0 1\n", "t", 1.0);
  EXPECT_NEAR(*stream.first_time(), 1403636579.7635556, 1e-6);
  EXPECT_NEAR(stream.at(1403636579.8135556)->translation().x(), 0.5, 1e-4);
}

TEST(PoseStream, AHeadNamesColumnsInAnyOrder) {
  for (const auto& [head, line] : std::vector<std::pair<std::string, std::string>>{
           {"timestamp,qw,qx,qy,qz,x,y,z", "1,0.5,0.1,-0.7,0.5,1,2,3"},
           {"# t qw qx qy qz tx ty tz", "1 0.5 0.1 -0.7 0.5 1 2 3"},
           {"# t x y z qy qx qz qw", "1 1 2 3 -0.7 0.1 0.5 0.5"},
           {"x,y,z,qx,qy,qz,qw,time", "1,2,3,0.1,-0.7,0.5,0.5,1"},
           {"frame,timestamp,x,y,z,qw,qx,qy,qz", "12,1,1,2,3,0.5,0.1,-0.7,0.5"},
           {"n,time [s],q_w [],q_x [],q_y [],q_z [],p_z [m],p_y [m],p_x [m]", "7,1,0.5,0.1,-0.7,0.5,3,2,1"},
           {"orientation.x,orientation.y,orientation.z,orientation.w,time,position.x,position.y,position.z",
            "0.1,-0.7,0.5,0.5,1,1,2,3"}}) {
    const PoseStream stream = parse_tum_poses(head + "\n" + line + "\n", "t", 1.0);
    ASSERT_TRUE(stream.at(1.0)) << head;
    EXPECT_LT((stream.at(1.0)->translation() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-9) << head;
    EXPECT_LT(Eigen::Quaterniond(stream.at(1.0)->rotation())
                  .angularDistance(Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5).normalized()),
              1e-9)
        << head;
  }
  // A line that was cut has no pose, though as many words as one.
  EXPECT_THROW(
      parse_tum_poses("frame,timestamp,x,y,z,qx,qy,qz,qw\n1,1,0,0,0,0,0,0,1\n2,2,0,0,0,0,0,1\n", "t", 5.0),
      std::invalid_argument);
}

TEST(PoseStream, LinesWithoutAPoseAreLeftOutAndCountedWhereThatIsAskedFor) {
  const std::string first = "1 0 0 0 0 0 0 1\n", last = "3 2 0 0 0 0 0 1\n";
  for (const std::string& text :
       {first + "2 nan nan nan nan nan nan nan\n" + last, first + "2 1 0 0 0 -inf 0 1\n" + last,
        first + last + "4 2 0 0", first + last + "4 2 0 0\n\n"}) {
    std::size_t left_out = 0;
    const PoseStream stream = parse_tum_poses(text, "p", 5.0, &left_out);
    EXPECT_EQ(left_out, 1U) << text;
    EXPECT_EQ(stream.size(), 2U);
    EXPECT_NEAR(stream.at(2.0).value().translation().x(), 1.0, 1e-9);
    EXPECT_THROW(parse_tum_poses(text, "p", 5.0), std::invalid_argument);
  }
  std::size_t left_out = 0;
  for (const std::string& text :
       {"2 1 0 0\n" + first, first + "2 1 0 0\n" + last, first + "nan 1 0 0 0 0 0 1\n" + last,
        first + "2 1 0 0 0 0 0 9\n", std::string("2 nan nan nan nan nan nan nan\n")})
    EXPECT_THROW(parse_tum_poses(text, "p", 5.0, &left_out), std::invalid_argument) << text;
}

TEST(PoseStream, OfTwoPosesOfOneTimeThatAreFarApartNoneIsTaken) {
  const std::string text = "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n";
  const auto with = [&](const std::string& line) {
    return complaint<std::invalid_argument>([&] { parse_tum_poses(text + line, "poses 'p'", 5.0); });
  };
  EXPECT_EQ(with("2 1 0 0 0 0 0 1\n"), "");     // as some logs repeat a line
  EXPECT_EQ(with("2 1.05 0 0 0 0 0 1\n"), "");  // at times that were rounded
  EXPECT_EQ(with("2 0 0 0 0 0 0 1\n"),
            "poses 'p': expected one pose a time, got two that are 1 m and 0 rad apart at 2 s");
  EXPECT_NE(with("2 1 0 0 0 0 0.70710678118654752 0.70710678118654752\n").find("0 m and 1.57 rad apart"),
            std::string::npos);
  std::string rounded;  // 30 Hz, 1 m/s, whole seconds
  for (int i = 0; i < 90; ++i)
    rounded += std::to_string(i / 30) + " " + std::to_string(i / 30.0) + " 0 0 0 0 0 1\n";
  EXPECT_EQ(parse_tum_poses(rounded, "p", 5.0).size(), 3U);
  EXPECT_NO_THROW(parse_tum_poses("1764300000 1 0 0 0 0 0 1\n1764300000 1 0 0 0 0 0 1\n", "p", 1e-9));
}

TEST(PoseStream, LinesWithCommasNeedAHead) {
  const std::string vins = "1403636579763555584,1,2,3,0.8,0,0,0.6,\n";  // VINS-Mono's, w first
  try {
    parse_tum_poses(vins, "p", 1.0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("line 1: programs that write commas differ"), std::string::npos);
  }
  const PoseStream poses = parse_tum_poses("time,x,y,z,qw,qx,qy,qz\n" + vins, "p", 1.0);
  const Eigen::Quaterniond turn(poses.at(*poses.first_time())->rotation());
  EXPECT_LT(turn.angularDistance(Eigen::Quaterniond(0.8, 0, 0, 0.6)), 1e-6);
  EXPECT_THROW(parse_tum_poses("1,2,3,4,0,0,0,1\n", "p", 1.0), std::invalid_argument);
}

TEST(PoseStream, AHeadWithoutCommasMayNameMoreColumnsBehindThePose) {
  const PoseStream poses =
      parse_tum_poses("#timestamp x y z qx qy qz qw id\n1 1 2 3 0 0 0.6 0.8 7\n", "p", 1.0);  // RTAB-Map's
  EXPECT_LT(Eigen::Quaterniond(poses.at(1.0)->rotation()).angularDistance(Eigen::Quaterniond(0.8, 0, 0, 0.6)),
            1e-9);
  EXPECT_EQ(
      parse_tum_poses("# time [s] x [m] y [m] z [m] qx qy qz qw\n1 1 2 3 0 0 0.6 0.8\n", "p", 1.0).size(),
      1U);
  EXPECT_THROW(parse_tum_poses("#timestamp x y z qx qy qz qw id\n1 1 2 3 0 0 0.6 0.8 7 7\n", "p", 1.0),
               std::invalid_argument);
}

TEST(PoseStream, OfOtherColumnsHowManyIsSaid) {
  try {
    parse_tum_poses("1 0 0 0 0 0 0 1 7 7\n", "p", 1.0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("got 10 columns"), std::string::npos) << error.what();
  }
}

TEST(PoseStream, NamesTheLineThatIsNoPose) {
  for (const char* bad :
       {"1 2 3\n", "1 0 0 0 0 0 0 2\n", "1 0 0 nan 0 0 0 1\n", "1 0 inf 0 0 0 0 1\n", "1 1e999 0 0 0 0 0 1\n",
        "infinity 0 0 0 0 0 0 1\n", "1 0 0 0 0 0 0 1 7\n", "x\n"}) {
    try {
      parse_tum_poses(std::string("# ok\n") + bad, "poses 'a.txt'", 1.0);
      FAIL() << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("poses 'a.txt', line 2: expected")) << error.what();
    }
  }
  EXPECT_THROW(parse_tum_poses("", "a", 1.0), std::invalid_argument);
  EXPECT_THROW(load_tum_poses("/nowhere/poses.txt", 1.0), std::invalid_argument);
  EXPECT_THROW(PoseStream(0.0), std::invalid_argument);
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

}  // namespace pose_stream_test
}  // namespace clearway
