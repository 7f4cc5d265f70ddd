#include "datasets/sources/joint_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace joint_stream_test {

const std::vector<std::string> both{"a", "b"};

TEST(JointStream, GoesInStraightLinesBetweenReadingsAndNowhereElse) {
  JointStream stream(0.5);
  stream.add(1.0, both, {0.0, 5.0});
  stream.add(1.4, both, {0.4, 3.0});
  stream.add(3.0, both, {1.0, 1.0});
  EXPECT_NEAR(stream.at(both, 1.1)->at(0), 0.1, 1e-12);
  EXPECT_NEAR(stream.at({"b", "a"}, 1.1)->at(0), 4.5, 1e-12) << "in the order asked for";
  EXPECT_EQ(stream.at(both, 3.0)->at(1), 1.0) << "at a reading itself";
  EXPECT_FALSE(stream.at(both, 0.9));
  EXPECT_FALSE(stream.at(both, 2.0)) << "in a gap";
  EXPECT_FALSE(stream.at(both, 3.1));
  EXPECT_FALSE(stream.at({"c"}, 1.1));
}

/// Drivers report a joint that turns on and on in [-pi, pi].
TEST(JointStream, OneThatWrapsGoesTheShorterWayRound) {
  JointStream stream(0.5);
  stream.add(10.0, {"wrist", "elbow"}, {3.1, 3.1});
  stream.add(10.1, {"wrist", "elbow"}, {-3.1, -3.1});
  stream.let_wrap("wrist");
  for (int i = 0; i <= 10; ++i) {
    const double time = 10.0 + 0.01 * i;
    const auto at = stream.at({"wrist", "elbow"}, time);
    ASSERT_TRUE(at);
    const double truth = 3.1 + 0.1 * i * (2.0 * M_PI - 6.2);  // on the circle
    EXPECT_NEAR(std::cos((*at)[0]), std::cos(truth), 1e-9) << time;
    EXPECT_NEAR(std::sin((*at)[0]), std::sin(truth), 1e-9) << time;
    EXPECT_NEAR((*at)[1], 3.1 - 0.62 * i, 1e-9) << time;
  }
  EXPECT_NEAR(stream.deviations({"wrist"}, 10.05, 1.0)[0], M_PI - 3.1, 1e-9);
  EXPECT_NEAR(stream.deviations({"elbow"}, 10.05, 1.0)[0], 3.1, 1e-9);
  EXPECT_EQ(stream.readings("wrist"), (std::map<double, double>{{10.0, 3.1}, {10.1, -3.1}}));
  stream.add(10.05, {"wrist"}, {0.5});
  stream.leave_out("wrist", 10.05);
  EXPECT_NEAR(std::cos((*stream.at({"wrist"}, 10.05))[0]), -1.0, 1e-9);
}

TEST(JointStream, DeviationsHoldEveryPlaceOfTheSpan) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  JointStream stream(0.5);
  double place = 0.0;
  for (int i = 0; i < 400; ++i) stream.add(0.013 * i, {"a"}, {place += 0.05 * normal(random)});
  for (int trial = 0; trial < 200; ++trial) {
    const double time = 0.5 + 4.0 * trial / 200.0, span = 0.001 * (trial % 60);
    const double here = stream.at({"a"}, time)->at(0), most = stream.deviations({"a"}, time, span)[0];
    double found = 0.0;
    for (int k = -200; k <= 200; ++k)
      found = std::max(found, std::abs(stream.at({"a"}, time + span * k / 200.0)->at(0) - here));
    EXPECT_GE(most, found - 1e-12);
    EXPECT_LE(most, found + 0.01) << "and is no larger than it need be";
  }
}

TEST(JointStream, ReadsATableAndNamesTheLineThatIsWrong) {
  const JointStream stream =
      parse_joint_states("# recorded\ntime, shoulder, elbow\n1, 0.5, -1\n\n2,0.6,-1.5\r\n", "j.csv", 2.0);
  EXPECT_EQ(stream.names(), (std::vector<std::string>{"elbow", "shoulder"}));
  EXPECT_DOUBLE_EQ(stream.at({"elbow"}, 1.5)->at(0), -1.25);
  const auto complaint_of = [](const std::string& text) {
    return complaint([&] { parse_joint_states(text, "j.csv", 2.0); });
  };
  EXPECT_NE(complaint_of("1,2,3\n").find("line 1: expected 'time' and the names"), std::string::npos);
  EXPECT_NE(complaint_of("time,a\n1,x\n").find("line 2: expected finite numbers"), std::string::npos);
  EXPECT_NE(complaint_of("time,a\n1,nan\n").find("line 2"), std::string::npos);
  EXPECT_NE(complaint_of("time,a,b\n1,2\n").find("expected 3 numbers, got 2"), std::string::npos);
  EXPECT_NE(complaint_of("time,a,a\n").find("a name of its own"), std::string::npos);
  EXPECT_NE(complaint_of("time,a\n").find("holds no joint positions"), std::string::npos);
}

}  // namespace joint_stream_test
}  // namespace clearway
