// Trajectories with times, as controllers run them, at `clearway check`.
#include "apps/check/timed_trajectory.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "apps/check/trajectory_entries.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/check/check_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace check_test {

/// Trajectories of the robot `point`, whose joints x and y have a velocity limit of 1 m/s, within the paint:
/// what lies within 1 m of the origin.
class CheckTimed : public Check {
 protected:
  struct Point {
    double time;
    Json positions, velocities = Json::array(), accelerations = Json::array();
  };
  static Json message(const std::vector<Point>& points) {
    Json message{{"joint_names", {"x", "y"}}, {"points", Json::array()}};
    for (const Point& point : points) {
      const auto nanoseconds = std::llround(point.time * 1e9);
      message["points"].push_back(
          {{"positions", point.positions},
           {"velocities", point.velocities},
           {"accelerations", point.accelerations},
           {"time_from_start",
            {{"sec", nanoseconds / 1'000'000'000}, {"nanosec", nanoseconds % 1'000'000'000}}}});
    }
    return message;
  }
  CommandRun check_file(const Json& message, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{
        "check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"), "--robot", "point"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  CommandRun check_points(const std::vector<Point>& points, std::vector<std::string> more = {}) const {
    return check_file(message(points), std::move(more));
  }
};

TEST_F(CheckTimed, ASwingBetweenEqualPointsIsSeen) {
  const auto swing = [&](double speed, double seconds) {
    return check_points({{0, {0, 0}, {speed, 0}}, {seconds, {0, 0}, {-speed, 0}}},
                        {"--accept-moving-start", "--accept-moving-end"});
  };
  EXPECT_EQ(swing(0.9, 1.0).status, exit_done) << swing(0.9, 1.0).out;  // 0.9 / 4 m
  const CommandRun wide = swing(0.9, 6.0);                              // 1.35 m
  EXPECT_EQ(wide.status, exit_no);
  EXPECT_NE(wide.out.find("s after the start: base comes too near to a voxel that is unknown"),
            std::string::npos)
      << wide.out;
  EXPECT_NE(wide.out.find("judged as ROS's joint_trajectory_controller runs it: 1 cubic"), std::string::npos);
  // Without the velocities it stands.
  EXPECT_EQ(check_points({{0, {0, 0}}, {6.0, {0, 0}}}).status, exit_done);
}

/// As of a file that was cut off: where the robot comes to rest is nobody's statement.
TEST_F(CheckTimed, AnEndInMotionIsRefusedUnlessItIsNamed) {
  const std::vector<Point> cut{{0, {0, 0}, {0, 0}}, {1.0, {0.2, 0}, {0.3, 0}}};
  const CommandRun refused = check_points(cut);
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find("refused for      the last point moves joint x at 0.3 a second"),
            std::string::npos)
      << refused.out;
  EXPECT_NE(refused.out.find("(--accept-moving-end accepts it)"), std::string::npos);
  const CommandRun accepted = check_points(cut, {"--accept-moving-end"});
  EXPECT_EQ(accepted.status, exit_done) << accepted.out;
  EXPECT_NE(accepted.out.find("accepted         the last point moves joint x"), std::string::npos)
      << accepted.out;
  EXPECT_EQ(check_points({{0, {0, 0}, {0, 0}}, {1.0, {0.2, 0}, {0, 0}}}).status, exit_done);
}

/// Nobody says how the robot gets to such a speed, unless it has time to.
TEST_F(CheckTimed, AStartInMotionIsRefusedUnlessItIsNamed) {
  const std::vector<Point> cut{{0, {0, 0}, {0.3, 0}}, {1.0, {0.2, 0}, {0, 0}}};
  const CommandRun refused = check_points(cut);
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find("refused for      the first point moves joint x at 0.3 a second"),
            std::string::npos)
      << refused.out;
  EXPECT_NE(refused.out.find("(--accept-moving-start accepts it)"), std::string::npos);
  EXPECT_EQ(check_points(cut, {"--accept-moving-end"}).status, exit_no);
  const CommandRun accepted = check_points(cut, {"--accept-moving-start"});
  EXPECT_EQ(accepted.status, exit_done) << accepted.out;
  EXPECT_NE(accepted.out.find("accepted         the first point moves joint x"), std::string::npos)
      << accepted.out;
  EXPECT_EQ(check_points({{0.5, {0, 0}, {0.3, 0}}, {1.5, {0.2, 0}, {0, 0}}}).status, exit_done);
}

/// Whether a joint may be as fast as at the first point depends on its acceleration limit and the time.
TEST_F(CheckTimed, AStartInMotionIsNoOtherOneWhereItBeginsALittleLater) {
  for (const double time : {1e-9, 1e-4, 9e-4}) {
    const std::vector<Point> cut{{time, {0, 0}, {0, -0.3}}, {1.0, {0, -0.2}, {0, 0}}};
    const CommandRun refused = check_points(cut);
    EXPECT_EQ(refused.status, exit_no);
    EXPECT_NE(refused.out.find("refused for      the first point moves joint y at -0.3 a second after"),
              std::string::npos)
        << refused.out;
    EXPECT_NE(refused.out.find("(--accept-moving-start accepts it)"), std::string::npos);
    EXPECT_EQ(check_points(cut, {"--accept-moving-start"}).status, exit_done);
  }
  Robot robot = load_robot("point");
  const auto sentence = [&](double time, double speed, double limit) {
    for (Joint& joint : robot.joints) joint.max_acceleration = limit;
    const ForeignTrajectory moving{.joints = {"x", "y"},
                                   .points = {{0.0, 0.0}, {0.1, 0.1}},
                                   .times = {time, time + 1.0},
                                   .velocities = {{0.0, speed}, {0.0, 0.0}},
                                   .accelerations = {{}, {}}};
    return timed_trajectory(moving, robot, "t.json")->moving_start;
  };
  EXPECT_EQ(sentence(0.05, -0.5, 5.0),
            "the first point moves joint y at -0.5 a second after 0.05 s: from rest that takes 10 m/s^2, "
            "beyond its acceleration limit of 5, expected it to start at rest");
  EXPECT_EQ(sentence(0.1, -0.5, 5.0), "");
  EXPECT_EQ(sentence(0.05, 0.0, 5.0), "");
  EXPECT_EQ(sentence(0.05, -0.5, 0.0), "") << "no limit is known";
  EXPECT_NE(sentence(5e-4, -0.5, 0.0), "") << "no controller is so quick";
  EXPECT_EQ(sentence(5e-4, -0.5, 2000.0), "");
}

TEST_F(CheckTimed, SpeedsBeyondALimitAreRefused) {
  const CommandRun fast = check_points({{0, {0, 0}, {0, 0}}, {0.001, {0.3, 0}, {0, 0}}});
  EXPECT_EQ(fast.status, exit_no);
  EXPECT_NE(
      fast.out.find("motion: edge 0, 0.0005 s after the start: the velocity of joint x is 450, its limit 1"),
      std::string::npos)
      << fast.out;
  const Json said =
      Json::parse(check_points({{0, {0, 0}, {0, 0}}, {0.001, {0.3, 0}, {0, 0}}}, {"--json"}).out);
  EXPECT_EQ(said["verdict"], "refused");
  EXPECT_EQ(said["motion"]["verdict"], "refused");
  EXPECT_NEAR(said["motion"]["velocity_share"].get<double>(), 450.0, 1e-6);
  // A line of 0.3 m at 0.75 and at 1.5 m/s; from rest to rest the cubic's greatest is half as much again.
  EXPECT_EQ(check_points({{0, {0, 0}}, {0.4, {0.3, 0}}}).status, exit_done);
  EXPECT_EQ(check_points({{0, {0, 0}}, {0.2, {0.3, 0}}}).status, exit_no);
  EXPECT_EQ(check_points({{0, {0, 0}, {0, 0}}, {0.4, {0.3, 0}, {0, 0}}}).status, exit_no);
  EXPECT_EQ(check_points({{0, {0, 0}, {0, 0}}, {0.45, {0.3, 0}, {0, 0}}}).status, exit_done);
  const CommandRun quintic =
      check_points({{0, {0, 0}, {0, 0}, {0, 0}}, {0.57, {0.3, 0}, {0, 0}, {0, 0}}}, {"--json"});
  EXPECT_EQ(quintic.status, exit_done) << quintic.out;
  EXPECT_NEAR(Json::parse(quintic.out)["motion"]["velocity_share"].get<double>(), 1.875 * 0.3 / 0.57, 1e-9);
  EXPECT_EQ(Json::parse(quintic.out)["motion"]["quintics"], 1);
  EXPECT_TRUE(Json::parse(quintic.out)["motion"]["acceleration_share"].is_null()) << quintic.out;
  EXPECT_NE(quintic.out.find("no acceleration limit of any joint"), std::string::npos) << quintic.out;
}

TEST_F(CheckTimed, OurOwnTrajectoriesStayValid) {
  const std::string ros = folder_.file("own.yaml"), json = folder_.file("own.json");
  const CommandRun run =
      run_command({"plan", "--map", folder_.file("map"), "--robot", "point", "--start=-0.3,0", "--goal=0.3,0",
                   "--goal=0.3,0.2", "--trajectory", "ros", ros, "--trajectory", "ros-json", json});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  for (const std::string& file : {ros, json}) {
    const CommandRun checked =
        run_command({"check", file, "--map", folder_.file("map"), "--robot", "point", "--json"});
    EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
    const Json motion = Json::parse(checked.out)["motion"];
    EXPECT_EQ(motion["verdict"], "valid");
    EXPECT_GT(motion["cubics"].get<int>() + motion["quintics"].get<int>(), 20);
    EXPECT_GT(motion["velocity_share"].get<double>(), 0.3);
    EXPECT_LE(motion["velocity_share"].get<double>(), 1.0 + 1e-6);
  }
}

TEST_F(CheckTimed, GoesFromWhereTheRobotIsInTheTimeOfTheFirstPoint) {
  const auto from = [&](double x, double time) {
    const Json robot{{"joint_state", {{"name", {"x", "y"}}, {"position", {x, 0.0}}}}};
    return check_file(
        {{"trajectory",
          {{{"joint_trajectory", message({{time, {0, 0}, {0, 0}}, {time + 1, {0, 0.1}, {0, 0}}})}}}},
         {"trajectory_start", robot}});
  };
  EXPECT_EQ(from(-0.3, 0.46).status, exit_done) << from(-0.3, 0.46).out;
  EXPECT_EQ(from(-0.3, 0.44).status, exit_no);  // 0.3 * 1.5 / 0.44 m/s
  EXPECT_EQ(from(-1.5, 60.0).status, exit_no);  // not painted
  EXPECT_EQ(from(-0.009, 0.0).status, exit_done);
  const CommandRun jump = from(-0.3, 0.0);
  EXPECT_EQ(jump.status, exit_no);
  EXPECT_NE(jump.out.find("joint x is at -0.3 before and at 0 at the first point, expected a time_from_start "
                          "above 0"),
            std::string::npos)
      << jump.out;
  const CommandRun unknown = check_points({{0.5, {0, 0}}, {1.0, {0.1, 0}}});
  EXPECT_EQ(unknown.status, exit_done);
  EXPECT_NE(unknown.out.find("where the robot is before the first point, which it reaches after 0.5 s"),
            std::string::npos)
      << unknown.out;
  EXPECT_NE(check_points({{0, {0, 0}, {0, 0}}, {1, {0.1, 0}, {0.1, 0}}}).out.find("how the robot stops"),
            std::string::npos);
}

/// Of the start the controller knows what the hardware states: each curve that it may take is judged.
TEST_F(CheckTimed, TheWayFromTheStartIsJudgedAsEachCurveThatAControllerMayTake) {
  const auto with_accelerations = [&](double ahead, Json velocity) {
    const Json robot{
        {"joint_state", {{"name", {"x", "y"}}, {"position", {0.0, 0.0}}, {"velocity", velocity}}}};
    const double a = -ahead * 4.0 / 3.0;  // 6 s from rest: the cubic goes 8 v / 9 ahead, the quintic less
    return check_file({{"trajectory",
                        {{{"joint_trajectory", message({{6, {0, 0}, {-ahead, 0}, {a, 0}},
                                                        {7, {-ahead / 3, 0}, {0, 0}, {0, 0}}})}}}},
                       {"trajectory_start", robot}});
  };
  EXPECT_EQ(with_accelerations(0.3, Json::array()).status, exit_done)
      << with_accelerations(0.3, Json::array()).out;
  EXPECT_EQ(with_accelerations(0.95, Json::array()).status, exit_no);
  EXPECT_EQ(with_accelerations(0.3, {0.0, 0.0}).status, exit_done);
  const CommandRun moving = with_accelerations(0.3, {0.5, 0.0});
  EXPECT_EQ(moving.status, exit_bad_input);
  EXPECT_NE(moving.log.find("only a robot that rests before a trajectory is judged"), std::string::npos)
      << moving.log;
}

/// Controllers before ROS 2 Jazzy go as far as the numbers say, later ones the shorter way.
TEST_F(CheckTimed, OfAnEndlessJointBothWaysFromTheStartAreJudged) {
  FreeSpaceMap map({.resolution = 0.05});
  map.paint(map.add_volume("one side", {}), {{0.3, 0.0, 0.0}, 0.5});  // holds the arm up to 97 degrees
  save_map(map.snapshot(), folder_.path() / "side");
  const std::string ball = "<sphere radius='0.05'/>",
                    urdf = folder_.write("turn.urdf",
                                         "<robot name='turn'>" + worlds::urdf_link("base", "0 0 0", ball) +
                                             worlds::urdf_link("arm", "0.3 0 0", ball) +
                                             worlds::urdf_joint("wheel", "continuous", "base", "arm", "0 0 0",
                                                                "0 0 1", worlds::urdf_limit(-9, 9)) +
                                             "</robot>");
  const auto from = [&](double start) {
    Json points = message({{8, {0.0}}, {9, {0.5}}});
    points["joint_names"] = {"wheel"};
    const Json before{{"joint_state", {{"name", {"wheel"}}, {"position", {start}}}}};
    return run_command(
        {"check",
         folder_.write(
             "turn.json",
             Json{{"trajectory", {{{"joint_trajectory", points}}}}, {"trajectory_start", before}}.dump()),
         "--map", folder_.file("side"), "--robot", urdf, "--policy", "painted"});
  };
  EXPECT_EQ(from(-0.083).status, exit_done) << from(-0.083).out << from(-0.083).log;
  const CommandRun far = from(-0.083 + 2.0 * std::numbers::pi);
  EXPECT_EQ(far.status, exit_no) << far.out;
  EXPECT_NE(far.out.find("arm comes too near to a voxel that is unknown"), std::string::npos) << far.out;
}

/// An obstacle beside the long way counts for the clearance, and that way's speed for the shares.
TEST_F(CheckTimed, FiguresAreThoseOfTheWorstWayFromTheStart) {
  FreeSpaceMap map({.resolution = 0.02});
  Scan scan;
  scan.points = {{-0.5F, 0.0F, 0.0F}};
  map.insert(scan);
  save_map(map.snapshot(), folder_.path() / "post");
  const std::string ball = "<sphere radius='0.05'/>",
                    urdf = folder_.write("turn.urdf",
                                         "<robot name='turn'>" + worlds::urdf_link("base", "0 0 0", ball) +
                                             worlds::urdf_link("arm", "0.3 0 0", ball) +
                                             worlds::urdf_joint("wheel", "continuous", "base", "arm", "0 0 0",
                                                                "0 0 1", worlds::urdf_limit(-9, 9)) +
                                             "</robot>");
  const auto from = [&](double start) {
    Json points = message({{8, {0.0}}, {9, {0.05}}});
    points["joint_names"] = {"wheel"};
    const Json before{{"joint_state", {{"name", {"wheel"}}, {"position", {start}}}}};
    const CommandRun run = run_command(
        {"check",
         folder_.write(
             "turn.json",
             Json{{"trajectory", {{{"joint_trajectory", points}}}}, {"trajectory_start", before}}.dump()),
         "--map", folder_.file("post"), "--robot", urdf, "--policy", "not_occupied", "--allow-outside", "all",
         "--json"});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    return Json::parse(run.out);
  };
  const Json near = from(-0.083), far = from(-0.083 + 2.0 * std::numbers::pi);
  EXPECT_GT(near["min_clearance_m"].get<double>(), 0.16);  // as far as the field knows
  EXPECT_LT(far["min_clearance_m"].get<double>(), 0.14);   // the arm's ball comes to 0.13 m from the post
  EXPECT_LT(near["motion"]["velocity_share"].get<double>(), 0.06);
  EXPECT_GT(far["motion"]["velocity_share"].get<double>(), 6.2 / 8.0);
}

TEST_F(CheckTimed, TimesAreReadByTheirNamesOrRefused) {
  const auto at = [&](const Json& first, const Json& second) {
    Json file = message({{0.0, {0, 0}}, {1.0, {0.4, 0}}});
    file["points"][0]["time_from_start"] = first;
    file["points"][1]["time_from_start"] = second;
    return check_file(file).status;
  };
  EXPECT_EQ(at({{"sec", 0}, {"nsec", 900'000'000}}, {{"sec", 1}, {"nsec", 100'000'000}}), exit_no);  // 2 m/s
  EXPECT_EQ(at({{"secs", 0}, {"nsecs", 100'000'000}}, {{"secs", 1}, {"nsecs", 0}}), exit_done);
  EXPECT_EQ(at({{"sec", 0}}, {{"sec", 1}}), exit_done);
  EXPECT_EQ(at(0.0, 0.5), exit_done);
  EXPECT_EQ(at(0.9, 1.1), exit_no);  // 2 m/s
  EXPECT_EQ(at(0.0, "1 s"), exit_bad_input);
  EXPECT_EQ(at(-0.5, 1.0), exit_bad_input);
  EXPECT_EQ(at({{"sec", 0}, {"nanos", 0}}, {{"sec", 1}, {"nanos", 0}}), exit_bad_input);
  EXPECT_EQ(at({{"sec", 0}, {"secs", 0}}, {{"sec", 1}, {"secs", 1}}), exit_bad_input);
  EXPECT_EQ(at(Json::object(), {{"sec", 1}}), exit_bad_input);
}

TEST_F(CheckTimed, TimesThatDoNotRiseAndRatesThatDoNotFitAreNamed) {
  const auto refusal = [&](const Json& message) {
    const CommandRun run = check_file(message);
    EXPECT_EQ(run.status, exit_bad_input) << message << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    return run.log;
  };
  const Json good = message({{0, {0, 0}, {0, 0}}, {1, {0.1, 0}, {0, 0}}, {2, {0.2, 0}, {0, 0}}});
  ASSERT_EQ(check_file(good).status, exit_done);
  const auto changed = [&](int point, const std::string& key, const Json& value) {
    Json message = good;
    message["points"][static_cast<std::size_t>(point)][key] = value;
    return message;
  };
  for (const auto& [message, words] : std::vector<std::pair<Json, std::string>>{
           {changed(2, "time_from_start", {{"sec", 1}, {"nanosec", 0}}),
            "points[2].time_from_start: expected more than the 1 s of the point before, got 1 s"},
           {changed(1, "time_from_start", {{"secs", 3}, {"nsecs", 500000000}}),
            "points[2].time_from_start: expected more than the 3.5 s of the point before, got 2 s"},
           {changed(1, "time_from_start", {{"sec", -1}, {"nanosec", 0}}), "time_from_start.sec"},
           {changed(1, "velocities", {1.0}), "points[1].velocities: expected none or 2 numbers"},
           {changed(1, "accelerations", {1.0, 0.0, 0.0}), "points[1].accelerations: expected none or 2"},
           {changed(1, "velocities", {"a", 0}), "points[1].velocities"}})
    EXPECT_NE(refusal(message).find(words), std::string::npos) << refusal(message);
  Json without = changed(1, "velocities", Json::array());
  without["points"][1]["accelerations"] = {0.0, 0.0};
  EXPECT_NE(refusal(without).find("points[1].velocities: expected them where there are accelerations"),
            std::string::npos);
  Json missing = good;
  missing["points"][1].erase("time_from_start");
  EXPECT_NE(refusal(missing).find("points[1].time_from_start: expected it as other points have it"),
            std::string::npos);
}

/// A mass of 2 kg, 0.5 m from a joint about the y axis: torque m r (g cos q + r a), of the quintic from rest
/// to rest, a brick beside it.
TEST_F(CheckTimed, TorquesBeyondALimitAreRefused) {
  const std::string robot = folder_.write(
      "pendulum.urdf",
      "<robot name='pendulum'><link name='base'/><link name='arm'><inertial><origin xyz='0.5 0 0'/><mass "
      "value='2'/><inertia ixx='1e-9' ixy='0' ixz='0' iyy='1e-9' iyz='0' "
      "izz='1e-9'/></inertial><collision><origin "
      "xyz='0.3 0 0'/><geometry><sphere radius='0.02'/></geometry></collision></link><joint name='turn' "
      "type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/><limit lower='-2' "
      "upper='2' "
      "effort='12' velocity='9'/></joint></robot>");
  const auto greatest = [](double seconds) {  // from 0 to -1 rad: up
    double most = 0.0;
    for (int i = 0; i <= 10000; ++i) {
      const double s = i / 10000.0, q = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
                   a = (60.0 * s - 180.0 * s * s + 120.0 * s * s * s) / (seconds * seconds);
      most = std::max(most, std::abs(2.0 * 0.5 * (9.81 * std::cos(q) + 0.5 * a)));
    }
    return most;
  };
  const auto check = [&](double seconds, std::vector<std::string> more = {}) {
    const auto nanoseconds = std::llround(seconds * 1e9);
    const Json rest{0.0};
    Json message{{"joint_names", {"turn"}}, {"points", Json::array()}};
    for (const double q : {0.0, -1.0})
      message["points"].push_back({{"positions", {q}},
                                   {"velocities", rest},
                                   {"accelerations", rest},
                                   {"time_from_start",
                                    {{"sec", q == 0.0 ? 0 : nanoseconds / 1'000'000'000},
                                     {"nanosec", q == 0.0 ? 0 : nanoseconds % 1'000'000'000}}}});
    more.insert(more.begin(), {"check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"),
                               "--robot", robot, "--json"});
    return run_command(more);
  };
  ASSERT_LT(greatest(2.0), 11.9);
  ASSERT_GT(greatest(0.7), 12.1);
  const CommandRun slow = check(2.0), quick = check(0.7);
  EXPECT_EQ(slow.status, exit_done) << slow.out << slow.log;
  EXPECT_NEAR(Json::parse(slow.out)["motion"]["torque_share"].get<double>(), greatest(2.0) / 12.0, 1e-3);
  EXPECT_EQ(quick.status, exit_no);
  EXPECT_NE(quick.out.find("the torque of joint turn is "), std::string::npos) << quick.out;
  EXPECT_NEAR(Json::parse(quick.out)["motion"]["torque_share"].get<double>(), greatest(0.7) / 12.0, 1e-3);
  const Robot pendulum = load_robot(robot);
  TimedTrajectory up, still;
  const Configuration low = Configuration::Zero(1), high = Configuration::Constant(1, -1.0);
  up.points = {{0.0, low, low, low}, {2.0, high, low, low}};
  still.points = {{0.0, high, low, low}, {1.0, high, low, low}};  // 9.81 cos 1 Nm
  for (const auto& entries : {std::vector{up, still}, std::vector{still, up}}) {
    SplineVerdict verdict;
    EXPECT_NEAR(torques_of(entries, pendulum, {}, verdict).share, greatest(2.0) / 12.0, 1e-3);
  }
  const std::string brick = folder_.write(
      "brick.yaml",
      "{name: brick, box: [0.02, 0.02, 0.02], link: arm, pose: [0.4, 0, 0, 0, 0, 0], mass: 0.5}");
  EXPECT_EQ(check(2.0, {"--attach", brick}).status, exit_no);
}

TEST_F(CheckTimed, ALoadRidesOnTheCurve) {
  const std::string bar = folder_.write("bar.yaml", "{name: bar, box: [0.02, 1.8, 0.01], link: base}");
  const std::vector<Point> swing{{0, {0, 0}, {0.9, 0}}, {2.0, {0, 0}, {-0.9, 0}}};  // 0.45 m
  const std::vector<std::string> accepted{"--accept-moving-start", "--accept-moving-end"};
  EXPECT_EQ(check_points(swing, accepted).status, exit_done);
  const CommandRun loaded = check_points(swing, {"--attach", bar, accepted[0], accepted[1]});
  EXPECT_EQ(loaded.status, exit_no);
  EXPECT_NE(loaded.out.find("bar comes too near"), std::string::npos) << loaded.out;
}

TEST_F(CheckTimed, JointsThatStandStillMayNotMoveBetweenItsPoints) {
  const std::string urdf = folder_.write("arm.urdf", worlds::arm_with_finger());
  const Robot robot = load_robot(RobotRequest{urdf, {}, {}, {{"grip", 0.03}}});
  ForeignTrajectory still{{"grip", "elbow", "shoulder"}, {{0.03, 0.1, 0.2}, {0.03, 0.3, 0.4}}};
  EXPECT_FALSE(timed_trajectory(still, robot, "t.json"));
  still.times = {0.0, 2.0};
  still.velocities = {{0.0, 0.5, 0.25}, {0.0, 0.0, 0.0}};
  still.accelerations = {{}, {}};
  const auto timed = timed_trajectory(still, robot, "t.json");
  ASSERT_TRUE(timed);
  EXPECT_EQ(timed->points.front().velocity, Eigen::VectorXd(Eigen::Vector2d(0.25, 0.5)));
  EXPECT_EQ(timed->points.back().position, Configuration(Eigen::Vector2d(0.4, 0.3)));
  EXPECT_EQ(timed->points.front().acceleration.size(), 0);
  still.velocities[1][0] = 1e-3;  // a swing of up to 4/27 of 2 mm
  EXPECT_THROW(timed_trajectory(still, robot, "t.json"), std::invalid_argument);
}

/// Positions alone: what no motion through the points can do is refused, and no sampled motion that keeps its
/// limits is.
TEST(TimedCorners, ATrajectoryThatNoLimitedMotionFollowsIsRefused) {
  Robot robot = load_robot("point");
  const double limit = 2.0;
  for (Joint& joint : robot.joints) joint.max_acceleration = limit, joint.max_velocity = 10.0;
  const auto fault = [&](const std::vector<std::pair<double, double>>& points) {
    TimedTrajectory trajectory;
    for (const auto& [time, x] : points) trajectory.points.push_back({time, Eigen::Vector2d(x, 0.0)});
    return check_timed(trajectory, robot, Snapshot(), {{"base", Policy::not_occupied}}, 0.0, 0.0).fault;
  };
  EXPECT_EQ(fault({{0, 0}, {1, 0.78}, {2, 0}}), "");  // 1.56 m/s^2 on the whole
  EXPECT_NE(fault({{0, 0}, {1, 1.02}, {2, 0}}), "");  // 2.04
  EXPECT_EQ(fault({{0, 0}, {1, 0.49}}), "");          // from rest to rest at 1.96 m/s^2
  EXPECT_NE(fault({{0, 0}, {1, 0.51}}), "");
  EXPECT_NE(fault({{0, 0}, {1, 0.5}, {1.1, 0.578}, {1.2, 0.5}, {3, 0}})
                .find("joint x has to come from 0.78 to -0.78 at the point at 1.1 s"),
            std::string::npos);
  EXPECT_NE(
      fault({{0, 0}, {0.1, 0.05}, {3, 0.1}}).find("joint x has to come from 0 to 0.5 at the point at 0 s"),
      std::string::npos);
  EXPECT_NE(fault({{0, 0}, {3, 0.05}, {3.1, 0.1}}).find("from 0.5 to 0 at the point at 3.1 s"),
            std::string::npos);
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 40; ++trial) {  // from rest to rest, with an acceleration of at most `limit`
    const double rate = std::uniform_real_distribution<double>(0.5, 6.0)(random),
                 period = std::uniform_real_distribution<double>(0.004, 0.3)(random);
    const double swing = limit / (rate * rate);
    std::vector<std::pair<double, double>> points;
    const double half = std::numbers::pi / rate;
    for (double t = 0.0; t < half; t += period) points.emplace_back(t, swing * (1.0 - std::cos(rate * t)));
    points.emplace_back(half, 2.0 * swing);
    EXPECT_EQ(fault(points), "") << rate << " " << period;
  }
}

/// What a point says of its velocity asks for more than what only follows from its neighbours.
TEST(TimedCorners, AStatedVelocityAtOneEndOfALineCounts) {
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_acceleration = 1.0, joint.max_velocity = 10.0;
  struct Known {
    double time, x;
    std::optional<double> velocity = std::nullopt;
  };
  const auto fault = [&](const std::vector<Known>& points) {
    TimedTrajectory trajectory;
    for (const Known& point : points) {
      trajectory.points.push_back({point.time, Eigen::Vector2d(point.x, 0.0)});
      if (point.velocity) trajectory.points.back().velocity = Eigen::Vector2d(*point.velocity, 0.0);
    }
    return check_timed(trajectory, robot, Snapshot(), {{"base", Policy::not_occupied}}, 0.0, 0.0).fault;
  };
  EXPECT_NE(fault({{0, 0, 0.0}, {1.9, 1}}), "");  // from rest to rest: 4 / 1.9^2
  EXPECT_EQ(fault({{0, 0, 0.0}, {2.1, 1}}), "");
  EXPECT_NE(fault({{0, 0}, {1.9, 1, 0.0}}), "");
  EXPECT_NE(fault({{0, 0}, {1, 0.1}, {2, 0.2, 1.0}, {3, 1.2, 1.0}, {5, 2.2}})
                .find("joint x has to come from 0.1 to 1 at the point at 2 s"),
            std::string::npos);
  std::mt19937_64 random(8);
  for (int trial = 0; trial < 60;
       ++trial) {  // velocity of 1 - cos, stated at some points, left out at others
    const double rate = std::uniform_real_distribution<double>(0.5, 4.0)(random);
    const double swing = 1.0 / (rate * rate), half = std::numbers::pi / rate;
    std::vector<Known> points;
    for (int i = 0; i <= 12; ++i) {
      const double time = half * i / 12;
      points.push_back({time, swing * (1.0 - std::cos(rate * time))});
      if (random() % 3 == 0) points.back().velocity = swing * rate * std::sin(rate * time);
    }
    for (std::size_t i = 0; i + 1 < points.size();
         ++i)  // two that state it in turn are a cubic, judged elsewhere
      if (points[i].velocity && points[i + 1].velocity) points[i + 1].velocity.reset();
    EXPECT_EQ(fault(points), "") << rate;
  }
}

/// The way with the least acceleration from one velocity to another: full speed up, then down.
TEST(TimedCorners, BothEndsOfALineAskForSpeedUpAndDown) {
  Robot robot = load_robot("point");
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double limit = 1.0, first = 0.1 + std::abs(unit(random)), up = 1.0 + 0.9 * unit(random),
                 top = first + limit * up;
    TimedTrajectory trajectory;  // its last point is where the robot rests: full braking from a velocity to 0
    trajectory.points.push_back({0.0, Eigen::Vector2d::Zero(), Eigen::Vector2d(first, 0.0)});
    const double braking = top / limit, way = (first + top) / 2 * up + top / 2 * braking;
    trajectory.points.push_back({up + braking, Eigen::Vector2d(way, 0.0)});
    for (const double share : {0.97, 1.05}) {
      for (Joint& joint : robot.joints) joint.max_acceleration = share * limit, joint.max_velocity = 100.0;
      const std::string fault =
          check_timed(trajectory, robot, Snapshot(), {{"base", Policy::not_occupied}}, 0.0, 0.0).fault;
      EXPECT_EQ(fault.empty(), share > 1.0) << fault;
    }
  }
}

/// `--start` says where the robot is before a first point that it reaches after some time.
TEST_F(CheckTimed, AStartThatIsStatedIsGoneFrom) {
  const std::vector<Point> one{{0.5, {0.2, 0.0}, {0, 0}}};
  const auto from = [&](const std::string& start) { return check_points(one, {"--start=" + start}); };
  EXPECT_EQ(from("0,0").status, exit_done) << from("0,0").out;
  EXPECT_EQ(from("0,0").out.find("is not said"), std::string::npos) << from("0,0").out;
  EXPECT_EQ(from("-0.3,0").status, exit_no);  // 0.5 m in 0.5 s by a cubic: 1.5 m/s
  EXPECT_EQ(from("0.2,0").status, exit_done);
  EXPECT_EQ(from("1e9,0").status, exit_bad_input);
  EXPECT_NE(from("1e9,0").log.find("beyond which angles lose their digits"), std::string::npos);
  EXPECT_NE(check_points(one).out.find("is not said"), std::string::npos);
  EXPECT_NE(check_points(one, {"--pick", folder_.write("pick.yaml", "x")})
                .log.find("does not say where its legs end"),
            std::string::npos);
}

}  // namespace check_test
}  // namespace clearway
