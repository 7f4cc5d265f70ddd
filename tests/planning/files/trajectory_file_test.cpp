#include "planning/files/trajectory_file.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

namespace clearway {
namespace trajectory_file_test {

/// `joints` turning joints, but the last one slides when `slides`.
Robot chain(int joints, bool slides) {
  Robot robot;
  robot.name = "chain";
  robot.links.push_back({});
  robot.links[0].name = "base: \"root\"";
  for (int j = 0; j < joints; ++j) {
    robot.joints.push_back({});
    robot.joints.back().name = j == 0 ? "yes" : "joint " + std::to_string(j);
  }
  if (slides) robot.joints.back().kind = JointKind::prismatic;
  return robot;
}

Plan plan_of(const Robot& robot) {
  Plan plan;
  plan.robot = robot.name + "\nend";  // must not leave its comment
  plan.planner = "beam";
  plan.map_file = "map.ot";
  plan.map_sha256 = std::string(64, 'f');
  return plan;
}

Trajectory motion(const Robot& robot) {
  const auto n = static_cast<Eigen::Index>(robot.dof());
  const Configuration from = Configuration::LinSpaced(n, -1e-7, 1.0 / 3.0);
  return time_parameterize(robot, {from, Configuration::Constant(n, -std::numbers::pi)});
}

std::string text_of(const std::string& format, const Robot& robot) {
  return trajectory_format(format, robot).write(robot, plan_of(robot), motion(robot));
}

Configuration numbers(const YAML::Node& list) {
  const auto values = list.as<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

TEST(TrajectoryFile, RosReadsBackToTheSameTrajectory) {
  for (const bool slides : {false, true}) {
    const Robot robot = chain(3, slides);
    const Trajectory trajectory = motion(robot);
    const YAML::Node yaml = YAML::Load(text_of("ros", robot));
    EXPECT_EQ(yaml["header"]["frame_id"].as<std::string>(), robot.links[0].name);
    ASSERT_EQ(yaml["joint_names"].size(), 3u);
    EXPECT_EQ(yaml["joint_names"][0].as<std::string>(), "yes");
    EXPECT_EQ(yaml["joint_names"][0].Tag(), "!");  // quoted: not a boolean
    ASSERT_EQ(yaml["points"].size(), trajectory.points.size());
    std::size_t k = 0;
    for (const YAML::Node& point : yaml["points"]) {
      const TrajectoryPoint& expected = trajectory.points[k++];
      EXPECT_EQ(numbers(point["positions"]), expected.position);
      EXPECT_EQ(numbers(point["velocities"]), expected.velocity);
      const YAML::Node time = point["time_from_start"];
      EXPECT_LT(time["nanosec"].as<int>(), 1'000'000'000);
      EXPECT_NEAR(time["sec"].as<int>() + 1e-9 * time["nanosec"].as<int>(), expected.time, 1e-9);
    }
  }
}

TEST(TrajectoryFile, NumbersAreNeitherIntegersNorPowersOfTen) {
  const std::string text = text_of("ros", chain(2, false));
  EXPECT_NE(text.find("positions: [-0.0000001, 0.3333333333333333]"), std::string::npos)
      << text.substr(0, 900);
  EXPECT_NE(text.find("velocities: [0.0, 0.0]"), std::string::npos);
}

TEST(TrajectoryFile, UrscriptStreamsEveryPointAtTheStatedPeriod) {
  const Robot robot = chain(6, false);
  const Trajectory trajectory = motion(robot);
  std::istringstream text(text_of("urscript", robot));
  std::size_t k = 0;
  int depth = 0;
  for (std::string line; std::getline(text, line);) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.starts_with("def ") || line.starts_with("while ") || line.starts_with("if ")) ++depth;
    if (line == "end") --depth;
    ASSERT_GE(depth, 0);
    if (!line.starts_with("servoj([")) continue;
    ASSERT_LT(k, trajectory.points.size());
    EXPECT_EQ(numbers(YAML::Load(line.substr(7, line.find(']') - 6))), trajectory.points[k++].position);
    EXPECT_NE(line.find("], t=0.008, lookahead_time=0.03, gain=300)"), std::string::npos) << line;
  }
  EXPECT_EQ(k, trajectory.points.size());
  EXPECT_EQ(depth, 0);
}

TEST(TrajectoryFile, TheHeadingNamesRobotPlannerAndMapAndStaysAComment) {
  for (const std::string format : {"ros", "urscript"}) {
    std::istringstream text(text_of(format, chain(6, false)));
    std::string heading, line;
    while (std::getline(text, line) && line.starts_with("#")) heading += line + "\n";
    for (const std::string& word : {std::string("chain\\nend"), std::string("beam"), std::string(64, 'f')})
      EXPECT_NE(heading.find(word), std::string::npos) << word << " in " << heading;
  }
}

/// Values of joints that are not in the trajectory, for which it was proved.
TEST(TrajectoryFile, WhatStandsStillIsNamed) {
  const Robot robot = chain(6, false);
  Plan plan;
  plan.robot = "chain";
  plan.group = "left";
  plan.held = {{"torso", -1.2}};
  plan.map_from_base =
      Eigen::Translation3d(0.1, 0.2, 0.3) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  Trajectory trajectory;
  trajectory.sampling_period = 0.008;
  for (const double time : {0.0, 0.008})
    trajectory.points.push_back(
        {time, Configuration::Zero(6), Configuration::Zero(6), Configuration::Zero(6)});
  for (const char* format : {"ros", "urscript"}) {
    const std::string text = trajectory_format(format, robot).write(robot, plan, trajectory);
    for (const char* line : {"\n# held: \"torso\" at -1.2\n", "\n# group: \"left\"\n",
                             "\n# base: at 0.1, 0.2, 0.3 m, quaternion x y z w 0, 0, 1, "})
      EXPECT_NE(text.find(line), std::string::npos) << line << " in " << text;
  }
  const auto json = nlohmann::json::parse(trajectory_format("json", robot).write(robot, plan, trajectory));
  EXPECT_EQ(json["held"]["torso"], -1.2);
  EXPECT_EQ(json["group"], "left");
  EXPECT_EQ(json["base"]["position_m"], (std::vector<double>{0.1, 0.2, 0.3}));
}

std::string refusal(const std::string& format, const Robot& robot) {
  try {
    trajectory_format(format, robot);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TrajectoryFile, UrscriptIsForSixRevoluteJointsAndUnknownFormatsAreNamed) {
  EXPECT_EQ(refusal("urscript", chain(6, false)), "accepted");
  EXPECT_EQ(refusal("ros", chain(2, true)), "accepted");
  EXPECT_EQ(
      refusal("urscript", chain(5, false)),
      "trajectory: urscript drives six revolute joints, robot 'chain' has 5 joints, 5 of them revolute");
  EXPECT_NE(refusal("urscript", chain(6, true)).find("6 joints, 5 of them revolute"), std::string::npos);
  EXPECT_NE(refusal("ross", chain(6, false)).find("'ross'; did you mean 'ros'?"), std::string::npos);
}

/// A motion of two knots with accelerations.
Trajectory smooth(const Robot& robot) {
  Trajectory trajectory = motion(robot);
  for (TrajectoryPoint& point : trajectory.points)
    point.acceleration = Configuration::Constant(static_cast<Eigen::Index>(robot.dof()), 1.0 / 3.0);
  return trajectory;
}

TEST(TrajectoryFile, AccelerationsAreWrittenWhereTheyAreKnown) {
  const Robot robot = chain(2, false);
  const Trajectory trajectory = smooth(robot);
  const YAML::Node ros = YAML::Load(trajectory_format("ros", robot).write(robot, plan_of(robot), trajectory));
  EXPECT_EQ(numbers(ros["points"][1]["accelerations"]), trajectory.points[1].acceleration);
  for (const char* format : {"ros-json", "json"}) {
    const auto json =
        nlohmann::json::parse(trajectory_format(format, robot).write(robot, plan_of(robot), trajectory));
    const bool is_ros = std::string(format) == "ros-json";
    const auto& names = json[is_ros ? "joint_names" : "joints"];
    EXPECT_EQ(names, nlohmann::json({"yes", "joint 1"}));
    for (std::size_t k = 0; k < trajectory.points.size(); ++k) {
      const auto values = [&](const char* what) {
        return (is_ros ? json["points"][k][what] : json[what][k]).get<std::vector<double>>();
      };
      const TrajectoryPoint& point = trajectory.points[k];
      EXPECT_EQ(values("positions"), std::vector<double>(point.position.begin(), point.position.end()));
      EXPECT_EQ(values("velocities"), std::vector<double>(point.velocity.begin(), point.velocity.end()));
      EXPECT_EQ(values("accelerations"),
                std::vector<double>(point.acceleration.begin(), point.acceleration.end()));
    }
  }
}

/// A motion that grasps at its fifth point and rests until its eighth.
Trajectory grasping(const Robot& robot) {
  Trajectory trajectory = motion(robot);
  for (std::size_t k : {5U, 6U, 7U}) trajectory.points[k].position = trajectory.points[4].position;
  trajectory.events.push_back({TrajectoryEvent::Kind::attach, "can \"1\", red", trajectory.points[4].time,
                               trajectory.points[7].time - trajectory.points[4].time});
  return trajectory;
}

TEST(TrajectoryFile, EachFormatThatCanSaysWhereTheHandGrasps) {
  const Robot robot = chain(6, false);
  const Trajectory trajectory = grasping(robot);
  const auto text_in = [&](const char* format) {
    return trajectory_format(format, robot).write(robot, plan_of(robot), trajectory);
  };
  EXPECT_NE(text_in("ros").find("# at 0.032 s: attach \"can \\\"1\\\", red\", at rest for 0.024 s\n"),
            std::string::npos);
  EXPECT_EQ(YAML::Load(text_in("ros"))["points"].size(), trajectory.points.size());
  const auto events = nlohmann::json::parse(text_in("json"))["events"];
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0]["time_s"], trajectory.events[0].time);
  EXPECT_EQ(events[0]["action"], "attach");
  EXPECT_EQ(events[0]["load"], "can \"1\", red");
  std::istringstream csv(text_in("csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_TRUE(line.ends_with(",event")) << line;
  for (std::size_t k = 0; std::getline(csv, line); ++k)
    EXPECT_EQ(line.ends_with(",\"attach can \"\"1\"\", red\""), k == 4) << line;
}

/// servoj lags behind, and a hand must not close before the arm is there: the program waits for it.
TEST(TrajectoryFile, UrscriptCallsAFunctionWhereTheHandGraspsAtRestAndStreamsNoRest) {
  const Robot robot = chain(6, false);
  const Trajectory trajectory = grasping(robot);
  const std::string text = trajectory_format("urscript", robot).write(robot, plan_of(robot), trajectory);
  EXPECT_NE(text.find("  def attach(load):\n"), std::string::npos);
  EXPECT_NE(text.find("    sleep(0.024)\n"), std::string::npos);
  EXPECT_EQ(text.find("def detach"), std::string::npos);
  std::istringstream lines(text);
  std::vector<std::string> calls;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  servoj(") || line.starts_with("  come_to_rest([") ||
        line.starts_with("  attach("))
      calls.push_back(line.substr(2, line.find('(') - 2));
  std::vector<std::string> expected(5, "servoj");
  expected.insert(expected.end(), {"come_to_rest", "attach"});
  expected.resize(expected.size() + trajectory.points.size() - 8, "servoj");
  expected.push_back("come_to_rest");
  EXPECT_EQ(calls, expected);
  const std::size_t stop = text.find("  come_to_rest([") + 15;
  EXPECT_EQ(numbers(YAML::Load(text.substr(stop, text.find(']', stop) + 1 - stop))),
            trajectory.points[4].position);
  const std::size_t rest = text.find("  def come_to_rest(target):"),
                    halt = text.find("    stopj(5.0)\n", rest);
  const std::string holding = text.substr(rest, halt - rest);
  EXPECT_NE(holding.find("while left > 0.0 and not is_at(target, 0.001):\n"
                         "      servoj(target, t=0.008, lookahead_time=0.03, gain=300)\n"
                         "      left = left - 0.008\n"),
            std::string::npos)
      << holding;
}

TEST(TrajectoryFile, UrscriptComesToRestOnceForLoadsThatAreTakenOneAfterTheOther) {
  const Robot robot = chain(6, false);
  Trajectory trajectory = grasping(robot);
  TrajectoryEvent& first = trajectory.events.front();
  first.rest = trajectory.points[5].time - first.time;
  trajectory.events.push_back({TrajectoryEvent::Kind::attach, "lid", trajectory.points[5].time,
                               trajectory.points[7].time - trajectory.points[5].time});
  const std::string text = trajectory_format("urscript", robot).write(robot, plan_of(robot), trajectory);
  const std::size_t stop = text.find("  come_to_rest([");
  const std::string calls = text.substr(text.find('\n', stop) + 1);
  EXPECT_TRUE(calls.starts_with("  attach(\"can \\\"1\\\", red\")\n  attach(\"lid\")\n  servoj(["))
      << calls.substr(0, 200);
}

/// A goal on the way is reached, not cut by the lag: once, where the arm has come to rest.
TEST(TrajectoryFile, UrscriptHoldsWhereThePathStopsOnItsWay) {
  const Robot robot = chain(6, false);
  Trajectory trajectory = motion(robot);
  const std::size_t goal = trajectory.points.size() - 1;
  for (int rests = 0; rests < 3; ++rests) trajectory.points.push_back(trajectory.points.back());
  for (std::size_t k = goal; k-- > 0;) trajectory.points.push_back(trajectory.points[k]);
  for (std::size_t k = 0; k < trajectory.points.size(); ++k)
    trajectory.points[k].time = 0.008 * static_cast<double>(k);
  std::istringstream text(trajectory_format("urscript", robot).write(robot, plan_of(robot), trajectory));
  std::vector<std::size_t> stops;
  std::size_t streamed = 0;
  for (std::string line; std::getline(text, line);) {
    streamed += line.starts_with("  servoj([");
    if (line.starts_with("  come_to_rest([")) stops.push_back(streamed);
  }
  EXPECT_EQ(stops, (std::vector<std::size_t>{goal + 4, trajectory.points.size()}));
}

TEST(TrajectoryFile, CsvHasAHeadingAndALineForEachPoint) {
  Robot robot = chain(2, false);
  robot.joints[1].name = "el,bow";
  const Trajectory trajectory = smooth(robot);
  std::istringstream text(trajectory_format("csv", robot).write(robot, plan_of(robot), trajectory));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(
      line,
      "time_s,yes,\"el,bow\",yes velocity,\"el,bow velocity\",yes acceleration,\"el,bow acceleration\"");
  std::size_t lines = 0;
  for (; std::getline(text, line); ++lines) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 6);
    std::istringstream numbers_of(line);
    std::string field;
    std::getline(numbers_of, field, ',');
    EXPECT_EQ(std::stod(field), trajectory.points.at(lines).time);
    std::getline(numbers_of, field, ',');
    EXPECT_EQ(std::stod(field), trajectory.points.at(lines).position[0]);
  }
  EXPECT_EQ(lines, trajectory.points.size());
  EXPECT_EQ(trajectory_format("csv", robot).write(robot, plan_of(robot), Trajectory{}),
            "time_s,yes,\"el,bow\",yes velocity,\"el,bow velocity\"\n");
}

}  // namespace trajectory_file_test
}  // namespace clearway
