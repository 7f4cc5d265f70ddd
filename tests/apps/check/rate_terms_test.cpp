// Rates that no limit is stated of, at `clearway check`.
#include "apps/check/rate_terms.hpp"

#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/check/check_command.hpp"

namespace clearway {
namespace check_test {

/// The robot `point` states velocity limits of 1 m/s, and nothing else.
class CheckRates : public Check {
 protected:
  /// From (0, 0) to (0.3, 0) in 0.6 s, between velocities of 0 or none.
  CommandRun check_way(bool has_velocities, std::vector<std::string> more = {}) const {
    Json message{{"joint_names", {"x", "y"}}, {"points", Json::array()}};
    for (const double x : {0.0, 0.3})
      message["points"].push_back(
          {{"positions", {x, 0.0}},
           {"velocities", has_velocities ? Json{0.0, 0.0} : Json::array()},
           {"time_from_start", {{"sec", 0}, {"nanosec", x == 0.0 ? 0 : 600'000'000}}}});
    more.insert(more.begin(), {"check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"),
                               "--robot", "point"});
    return run_command(more);
  }
};

/// A limit that nobody stated is no reason to refuse, and no reason to say nothing.
TEST_F(CheckRates, WhatIsNotJudgedIsSaidWithItsPeak) {
  const CommandRun run = check_way(true);
  EXPECT_EQ(run.status, exit_done) << run.out;
  EXPECT_NE(run.out.find("not judged: the robot states no acceleration limit of any joint; peak 5 m/s^2 of "
                         "joint x at 0 s, where plan keeps 5\n"),
            std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("not judged: controllers of ROS do not limit it; peak 16.7 m/s^3 of joint x at 0 s, "
                         "between points\n"),
            std::string::npos)
      << run.out;
  EXPECT_EQ(run.out.find("no velocity limit"), std::string::npos) << run.out;
  const Json motion = Json::parse(check_way(true, {"--json"}).out)["motion"], rates = motion["not_judged"];
  ASSERT_EQ(rates.size(), 2U) << motion;
  EXPECT_EQ(rates[0]["rate"], "acceleration");
  EXPECT_EQ(rates[0]["joints"], Json({"x", "y"}));
  EXPECT_EQ(rates[0]["joint"], "x");
  EXPECT_NEAR(rates[0]["peak"].get<double>(), 6.0 * 0.3 / 0.36, 1e-9);
  EXPECT_EQ(rates[0]["usual_limit"], 5.0);
  EXPECT_EQ(rates[1]["rate"], "jerk");
  EXPECT_NEAR(rates[1]["peak"].get<double>(), 12.0 * 0.3 / 0.216, 1e-9);
  EXPECT_TRUE(motion["acceleration_share"].is_null());
}

/// Of a line from rest to rest: the least that any motion through its ends takes.
TEST_F(CheckRates, OfStraightLinesThePeakIsWhatTheirPointsAskFor) {
  const Json rates = Json::parse(check_way(false, {"--json"}).out)["motion"]["not_judged"];
  ASSERT_EQ(rates.size(), 1U) << rates;
  EXPECT_EQ(rates[0]["rate"], "acceleration");
  EXPECT_NEAR(rates[0]["peak"].get<double>(), 4.0 * 0.3 / 0.36, 1e-9);
}

TEST_F(CheckRates, WhatIsJudgedIsNot) {
  Robot robot = load_robot("point");
  SplineVerdict verdict;
  EXPECT_TRUE(unjudged_rates(verdict, robot).empty());
  verdict.free_velocity = RatePeak{2.0, 1, 0.25, "trajectory[1]"};
  robot.joints[1].max_velocity = 0.0;
  const std::vector<UnjudgedRate> rates = unjudged_rates(verdict, robot);
  ASSERT_EQ(rates.size(), 1U);
  EXPECT_EQ(rates[0].sentence,
            "not judged: the robot states no velocity limit of y; peak 2 m/s of joint y at 0.25 s of "
            "trajectory[1], where plan keeps 1");
}

/// A plan's own motion is held to the limits that it was planned with.
TEST_F(CheckRates, AMotionIsJudgedByTheUsualLimitsAndSaysSo) {
  const std::string file = folder_.file("moving.json");
  ASSERT_EQ(run_command({"plan", "--map", folder_.file("map"), "--robot", "point", "--start=-0.3,0",
                         "--goal=0.3,0", "--motion", "--out", file})
                .status,
            exit_done);
  const CommandRun run = run_command({"check", file, "--map", folder_.file("map"), "--robot", "point"});
  EXPECT_EQ(run.status, exit_done) << run.out;
  EXPECT_NE(
      run.out.find("the motion is judged by the usual limits where the robot states none: acceleration of "
                   "any joint, 5 rad/s^2 (m/s^2); jerk of any joint, what builds up the whole "
                   "acceleration in 50 ms"),
      std::string::npos)
      << run.out;
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_acceleration = joint.max_jerk = 1.0;
  EXPECT_EQ(usual_limits_note(robot), "");
}

}  // namespace check_test
}  // namespace clearway
