#include "datasets/poses/tum_poses.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace tum_poses_test {

TEST(TumPoses, ReadsEurocsGroundTruth) {
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

TEST(TumPoses, ReadsNewerCollegesSecondsAndNanoseconds) {
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
TEST(TumPoses, ThatCanHardlyBeMetresIsTold) {
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

TEST(TumPoses, ReadsTheTumFormat) {
  const PoseStream stream = parse_tum_poses(
      "# time x y z qx qy qz qw\n1.0 1 2 3 0 0 0 1\n\n1.2 1 2 5 0 0 0.70710678 0.70710678  # turned\n", "t",
      1.0);
  EXPECT_EQ(stream.size(), 2U);
  const auto middle = stream.at(1.1);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->translation().z(), 4.0, 1e-5);
  EXPECT_NEAR(Eigen::AngleAxisd(middle->rotation()).angle(), M_PI / 4, 1e-5);
}

TEST(TumPoses, AHeadSaysTheOrderOfTheQuaternionAndNanosecondsAreTimes) {
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

TEST(TumPoses, AHeadNamesColumnsInAnyOrder) {
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

TEST(TumPoses, LinesWithoutAPoseAreLeftOutAndCountedWhereThatIsAskedFor) {
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

TEST(TumPoses, OfTwoPosesOfOneTimeThatAreFarApartNoneIsTaken) {
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

TEST(TumPoses, LinesWithCommasNeedAHead) {
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

TEST(TumPoses, AHeadWithoutCommasMayNameMoreColumnsBehindThePose) {
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

TEST(TumPoses, OfOtherColumnsHowManyIsSaid) {
  try {
    parse_tum_poses("1 0 0 0 0 0 0 1 7 7\n", "p", 1.0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("got 10 columns"), std::string::npos) << error.what();
  }
}

TEST(TumPoses, NamesTheLineThatIsNoPose) {
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

}  // namespace tum_poses_test
}  // namespace clearway
