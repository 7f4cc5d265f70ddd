#include "datasets/sources/joint_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

/// Stands, turns by this much within a tenth of a second from 1.0 s on, and stands.
double quick_turn(double time, double angle) {
  const double share = std::clamp((time - 1.0) / 0.1, 0.0, 1.0);
  return angle * (3.0 * share * share - 2.0 * share * share * share);
}

TEST(JointStream, WhileReadingsAreMissingAJointMayBeElsewhere) {
  JointStream stream(0.5);
  for (int i = 0; i <= 300; ++i)
    if (const double time = 0.01 * i; time < 1.005 || time > 1.4895)
      stream.add(time, {"pan"}, {quick_turn(time, 0.215)});
  for (int i = 0; i <= 2900; ++i) {
    const double time = 0.05 + 0.001 * i, at = stream.at({"pan"}, time)->at(0),
                 open = stream.uncertainties({"pan"}, time, 0.0)[0];
    EXPECT_LE(std::abs(quick_turn(time, 0.215) - at), open + 1e-9) << time;
    const bool is_read = time < 0.98 || time > 1.51;
    EXPECT_TRUE(!is_read || open < 1e-9) << "it stands at " << time;
  }
  EXPECT_GT(stream.uncertainties({"pan"}, 0.99, 0.05)[0], 0.05) << "within the span";
}

/// By arithmetic.
TEST(JointStream, AcrossMissingReadingsItCanDoWhatIsStated) {
  JointStream stream(0.5);
  for (int i = 0; i <= 200; ++i)
    if (i <= 100 || i >= 140) stream.add(0.01 * i, {"a", "b", "rests"}, {0.01 * i, 0.01 * i, 1.0});
  stream.let_accelerate("b", 2.0);
  const std::vector<double> open = stream.uncertainties({"a", "b", "rests"}, 1.1, 0.0);
  EXPECT_NEAR(open[0], 10.0 * 0.1 * 0.3 / 2.0, 1e-9);
  EXPECT_NEAR(open[1], 2.0 * 0.1 * 0.3 / 2.0, 1e-9);
  EXPECT_NEAR(open[2], open[0], 1e-9);
  EXPECT_NEAR(stream.uncertainties(both, 1.1, 0.06)[1], 2.0 * 0.16 * 0.24 / 2.0, 1e-9);
  EXPECT_NEAR(stream.uncertainties(both, 1.1, 0.5)[1], 2.0 * 0.2 * 0.2 / 2.0, 1e-9);
  JointStream lonely(0.5);
  lonely.add(1.0, {"a"}, {0.0});
  lonely.add(1.4, {"a"}, {0.0});
  EXPECT_NEAR(lonely.uncertainties({"a"}, 1.1, 0.0)[0], 10.0 * 0.1 * 0.3 / 2.0, 1e-9);
}

/// Smooth motion that is read as usual is known far better than what the joint could do; a reading that is
/// missing, or comes twice, changes that little.
TEST(JointStream, RegularReadingsOfASmoothMotionTellWhatIsBetweenThem) {
  for (const double rate : {1000.0, 100.0, 30.0, 10.0, 3.0}) {
    JointStream stream(0.5);
    const auto truth = [](double time) { return 0.8 * std::sin(1.5 * time); };
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 1e-5);
    const int count = static_cast<int>(8.0 * rate);
    for (int i = 0; i <= count; ++i) {
      const double time = i / rate;
      if (rate >= 10.0 && i % 17 == 5) continue;
      stream.add(time, {"a"}, {truth(time) + noise(random)});
      if (i % 8 == 0) stream.add(time + 1e-4 / rate, {"a"}, {truth(time) + noise(random)});
    }
    const double most = 0.8 * 1.5 * 1.5 / (rate * rate) + 3e-4;
    for (double time = 0.5; time < 7.0; time += 0.0137) {
      const double off = std::abs(truth(time) - stream.at({"a"}, time)->at(0)),
                   open = stream.uncertainties({"a"}, time, 0.0)[0];
      EXPECT_LE(off, open + 5e-5) << rate << ' ' << time;
      EXPECT_LE(open, most) << rate << ' ' << time;
    }
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
