// Trajectories of other programs, and plans with their joints in another order, at `clearway check`.
#include "apps/check/trajectory_plan.hpp"

#include "apps/check/timed_trajectory.hpp"
#include "apps/check/trajectory_entries.hpp"
#include "mapping/files/map_digest.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/check/check_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace check_test {

/// Checks a file of this name and text for the robot `point`, whose joints are x and y.
class CheckTrajectory : public Check {
 protected:
  CommandRun check_file(const std::string& name, const std::string& text,
                        std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{
        "check", folder_.write(name, text), "--map", folder_.file("map"), "--robot", "point"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  static Json trajectory(const Json& points, const Json& names = {"x", "y"}) {
    Json message{{"header", {{"frame_id", "world"}}}, {"joint_names", names}, {"points", Json::array()}};
    for (const Json& positions : points)
      message["points"].push_back(
          {{"positions", positions}, {"time_from_start", {{"sec", 0}, {"nanosec", 0}}}});
    return message;
  }
};

TEST_F(CheckTrajectory, EachFormOfAJointTrajectoryIsCheckedInTheRobotsOrder) {
  // Painted is what lies within 1 of the origin; the disc's radius is 0.05.
  const Json inside = trajectory({{0.0, 0.5}, {0.5, 0.0}, {0.5, 0.0}}),
             flat{{"trajectory", {{{"joint_trajectory", inside}}}}};
  for (const Json& message : {inside, Json{{"joint_trajectory", inside}}, flat}) {
    const CommandRun run = check_file("t.json", message.dump(), {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    const Json said = Json::parse(run.out);
    EXPECT_EQ(said["waypoints"], 2);
    EXPECT_EQ(said["policy"]["base"], "painted");
    EXPECT_EQ(said["padding_m"], 0.001);
    EXPECT_EQ(said["contract"]["start"]["value"], Json({0.0, 0.5}));
    EXPECT_EQ(check_file("t.yaml", message.dump()).status, exit_done);
  }
  EXPECT_EQ(check_file("t.yaml",
                       "header:\n  seq: 0\njoint_names: [y, x]\npoints:\n  - positions: [0.5, 0.0]\n"
                       "    velocities: []\n  - positions: [0.0, 0.7]\n---\n")
                .status,
            exit_done);
  // The same points in the other order of names lead out of the paint at y = -1.2.
  const Json leaving = trajectory({{0.0, 0.5}, {-1.2, 0.0}}, {"y", "x"});
  const CommandRun refused = check_file("t.json", leaving.dump());
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find("straight edges"), std::string::npos) << refused.out;
  // What the user asks for holds.
  EXPECT_EQ(check_file("t.json", inside.dump(), {"--goal=0.5,0", "--start=0,0.5"}).status, exit_done);
  EXPECT_EQ(check_file("t.json", inside.dump(), {"--goal=0.4,0"}).status, exit_no);
  EXPECT_EQ(check_file("t.json", inside.dump(), {"--padding", "0.6"}).status, exit_no);
  EXPECT_EQ(
      check_file("t.json", leaving.dump(), {"--policy", "not_occupied", "--allow-outside", "all"}).status,
      exit_done);
}

/// A trajectory of several legs does not say where they end.
TEST_F(CheckTrajectory, GoalsOnTheWayAreFoundInTurn) {
  const std::string way = trajectory({{0.0, 0.5}, {0.2, 0.3}, {0.5, 0.0}, {0.0, 0.5}, {0.2, 0.3}}).dump();
  const auto check_goals = [&](const std::vector<std::string>& goals) {
    std::vector<std::string> more{"--start=0,0.5"};
    for (const std::string& goal : goals) more.push_back("--goal=" + goal);
    return check_file("t.json", way, more);
  };
  EXPECT_EQ(check_goals({"0.2,0.3"}).status, exit_done);
  const CommandRun passed = check_goals({"0.2,0.3", "0.5,0", "0.2,0.3"});
  EXPECT_EQ(passed.status, exit_done) << passed.out;
  EXPECT_NE(passed.out.find("comes to the goals before the last at its points 2, 3"), std::string::npos)
      << passed.out;
  EXPECT_EQ(check_goals({"0.5,0", "0.2,0.3"}).status, exit_done);
  for (const std::vector<std::string>& goals : {std::vector<std::string>{"0.5,0.01", "0.2,0.3"},
                                                {"0.5,0", "0,0.5"},
                                                {"0.5,0", "0.5,0.1", "0.2,0.3"}}) {
    const CommandRun missed = check_goals(goals);
    EXPECT_EQ(missed.status, exit_no) << goals.front();
    EXPECT_NE(missed.out.find("goal "), std::string::npos) << missed.out;
  }
}

/// What rides on one leg alone would ride on none of a trajectory that is cut into legs without it.
TEST_F(CheckTrajectory, ItIsNotCutIntoLegsWhereSomethingRides) {
  const std::string rod =
      folder_.write("rod.yaml", "{name: rod, box: [0.02, 0.02, 0.02], link: base, legs: [1]}");
  const CommandRun run =
      check_file("t.json", trajectory({{0.0, 0.5}, {0.5, 0.0}, {0.0, 0.3}}).dump(),
                 {"--start=0,0.5", "--goal=0.5,0", "--goal=0,0.3", "--attach", rod, "--json"});
  EXPECT_EQ(run.status, exit_no) << run.out << run.log;
  EXPECT_EQ(run.out.find("comes to the goals before the last"), std::string::npos) << run.out;
}

/// `plan --export json`: what it says is checked as the same message of ROS is.
TEST_F(CheckTrajectory, OurOwnExportWithAListForEachQuantityIsRead) {
  const auto own = [](const Json& positions) {
    return Json{{"robot", "point"},
                {"joints", {"x", "y"}},
                {"times_s", {0, 2, 4}},
                {"positions", positions},
                {"velocities", {{0, 0}, {0, 0}, {0, 0}}},
                {"accelerations", {Json::array(), Json::array(), Json::array()}}};
  };
  const Json inside = {{0.0, 0.5}, {0.5, 0.0}, {0.5, 0.3}};
  const CommandRun run = check_file("t.json", own(inside).dump(), {"--json"});
  EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_EQ(check_file("t.json", own({{0.0, 0.5}, {0.5, 0.0}, {1.2, 0.0}}).dump()).status, exit_no);
  EXPECT_EQ(check_file("t.json", own({{0.0, 0.5}, {0.5, 0.0}, {-0.9, 0.0}}).dump()).status, exit_no);
  const auto refusal = [&](const std::string& field, const Json& value) {
    Json changed = own(inside);
    changed[field] = value;
    const CommandRun refused = check_file("t.json", changed.dump());
    EXPECT_EQ(refused.status, exit_bad_input) << field;
    return refused.log;
  };
  EXPECT_NE(refusal("times_s", {0, 2}).find("expected as many as there are positions, 3, got 2"),
            std::string::npos);
  EXPECT_NE(refusal("times_s", {0, 2, 2}).find("expected times that rise, got 2 after 2"), std::string::npos);
  EXPECT_NE(refusal("velocities", {{0, 0}, {0}, {0, 0}})
                .find("expected 2 numbers or none for each of the 3 points"),
            std::string::npos);
  EXPECT_NE(refusal("positions", Json::array()).find("expected at least one"), std::string::npos);
  EXPECT_NE(refusal("events", {{{"action", "attach"}}}).find("is in the plan's JSON"), std::string::npos);
  const CommandRun table = check_file("t.csv", "time_s,x,y\n0,0,0\n");
  EXPECT_EQ(table.status, exit_bad_input);
  EXPECT_NE(table.log.find("is for spreadsheets, expected a plan's JSON"), std::string::npos) << table.log;
}

TEST_F(CheckTrajectory, WhereTheRobotIsBeforeItCounts) {
  const auto from = [&](double x) {
    const Json message{
        {"trajectory", {{{"joint_trajectory", trajectory({{0.3, 0.0}, {0.5, 0.0}})}}}},
        {"trajectory_start", {{"joint_state", {{"name", {"x", "y"}}, {"position", {x, 0.0}}}}}}};
    return check_file("t.json", message.dump());
  };
  EXPECT_EQ(from(-0.2).status, exit_done);
  EXPECT_EQ(from(-1.5).status, exit_no);  // not painted
}

/// What actions and services of ROS and MoveIt wrap round a trajectory.
TEST_F(CheckTrajectory, GoalsAndResponsesAreReadAsTheTrajectoryInThem) {
  const Json inside = trajectory({{0.3, 0.0}, {0.5, 0.0}}), robots = {{"joint_trajectory", inside}},
             start = {{"joint_state", {{"name", {"x", "y"}}, {"position", {-0.2, 0.0}}}}};
  const auto waypoints = [&](const Json& message) {
    const CommandRun run = check_file("t.json", message.dump(), {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    return Json::parse(run.out)["waypoints"].get<int>();
  };
  EXPECT_EQ(waypoints({{"trajectory", inside}, {"goal_time_tolerance", {{"sec", 1}}}}), 2);
  EXPECT_EQ(waypoints({{"goal_id", {{"id", ""}}}, {"goal", {{"trajectory", inside}}}}), 2);
  EXPECT_EQ(waypoints({{"trajectory", robots}}), 2);
  EXPECT_EQ(waypoints({{"result", {{"planned_trajectory", robots}, {"trajectory_start", start}}}}), 3);
  Json response = {{"motion_plan_response",
                    {{"trajectory", robots}, {"trajectory_start", start}, {"error_code", {{"val", 1}}}}}};
  EXPECT_EQ(waypoints(response), 3);
  response["motion_plan_response"]["error_code"]["val"] = -1;
  const CommandRun failed = check_file("t.json", response.dump());
  EXPECT_EQ(failed.status, exit_bad_input);
  EXPECT_NE(failed.log.find("where planning failed"), std::string::npos) << failed.log;
}

/// A DisplayTrajectory names its robot; RViz warns, and shows it nevertheless.
TEST_F(CheckTrajectory, AModelOfAnotherNameIsSaid) {
  const auto notes_with = [&](const Json& model) {
    Json message{{"model_id", model},
                 {"trajectory", {{{"joint_trajectory", trajectory({{0.3, 0.0}, {0.5, 0.0}})}}}}};
    const CommandRun run = check_file("t.json", message.dump(), {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    return Json::parse(run.out)["contract"]["notes"].dump();
  };
  EXPECT_NE(
      notes_with("ur10e").find("the trajectory is for robot 'ur10e' (model_id), and judged for 'point'"),
      std::string::npos)
      << notes_with("ur10e");
  for (const char* same : {"", "point"})
    EXPECT_EQ(notes_with(same).find("model_id"), std::string::npos) << same;
}

/// MoveIt says by a virtual joint where the base stands: 0.6 along x the disc is painted for other values.
TEST_F(CheckTrajectory, ABaseThatTheFilePutsElsewhereIsNotJudgedHere) {
  const auto all_at = [&](const std::vector<double>& places, const std::vector<std::string>& flags) {
    Json transforms = Json::array();
    for (const double x : places)
      transforms.push_back({{"translation", {{"x", x}, {"y", 0}, {"z", 0}}},
                            {"rotation", {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}}}});
    const Json names(std::vector<std::string>(places.size(), "joint")),
        message{{"trajectory", {{{"joint_trajectory", trajectory({{-0.3, 0.0}, {-0.5, 0.0}})}}}},
                {"trajectory_start",
                 {{"multi_dof_joint_state", {{"joint_names", names}, {"transforms", transforms}}}}}};
    return check_file("t.json", message.dump(), flags);
  };
  const auto at = [&](double x, const std::vector<std::string>& flags) { return all_at({x}, flags); };
  EXPECT_EQ(at(0.0, {}).status, exit_done);
  EXPECT_EQ(at(0.0, {"--base=0.2,0,0"}).status, exit_done) << "the identity says nothing";
  const CommandRun elsewhere = at(0.6, {});
  EXPECT_EQ(elsewhere.status, exit_bad_input);
  EXPECT_NE(elsewhere.log.find("expected --base 0.6,0,0,0,0,0,"), std::string::npos) << elsewhere.log;
  EXPECT_EQ(at(0.6, {"--base=0.6,0,0"}).status, exit_done);
  EXPECT_EQ(at(1.6, {"--base=1.6,0,0"}).status, exit_no);
  EXPECT_EQ(at(0.6, {"--base=0.5,0,0"}).status, exit_bad_input);
  EXPECT_EQ(all_at({0.0, 0.6}, {"--base=0.6,0,0"}).status, exit_done);
  const CommandRun two = all_at({0.5, 0.6}, {"--base=0.6,0,0"});
  EXPECT_EQ(two.status, exit_bad_input) << "which of them holds the base?";
  EXPECT_NE(two.log.find("expected at most one that is not the identity"), std::string::npos) << two.log;
}

/// By a tenth of a millimetre and of a milliradian: what that moves is padded.
TEST_F(CheckTrajectory, ABaseMayStandAndBeTurnedALittleBesideWhereItIsJudged) {
  const auto is_accepted = [](const Eigen::Isometry3d& base) {
    ForeignTrajectory trajectory;
    trajectory.map_from_base = base;
    try {
      require_base(trajectory, Eigen::Isometry3d::Identity(), "t.json");
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  };
  for (const double beside : {0.9e-4, 1.1e-4, 0.1}) {
    const Eigen::Isometry3d moved(Eigen::Translation3d(0, -beside, 0)),
        turned(Eigen::AngleAxisd(beside, Eigen::Vector3d::UnitX()));
    EXPECT_EQ(is_accepted(moved), beside < 1e-4) << beside;
    EXPECT_EQ(is_accepted(turned), beside < 1e-4) << beside;
  }
}

TEST_F(CheckTrajectory, JointsThatAreNotNamedStandWhereTheRobotIsBefore) {
  const auto from = [&](double y) {
    const Json message{
        {"trajectory", {{{"joint_trajectory", trajectory({{0.3}, {0.5}}, {"x"})}}}},
        {"trajectory_start", {{"joint_state", {{"name", {"y", "x"}}, {"position", {y, 0.3}}}}}}};
    return check_file("t.json", message.dump());
  };
  const CommandRun run = from(0.1);
  EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_NE(run.out.find("does not name y: judged where trajectory_start has it"), std::string::npos)
      << run.out;
  EXPECT_EQ(from(1.2).status, exit_no);  // not painted
  EXPECT_EQ(check_file("t.json", trajectory({{0.3}, {0.5}}, {"x"}).dump()).status, exit_bad_input);
}

TEST_F(CheckTrajectory, WhatDoesNotFitTheRobotIsNamed) {
  const auto refusal = [&](const Json& message) {
    const CommandRun run = check_file("t.json", message.dump());
    EXPECT_EQ(run.status, exit_bad_input) << message;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    return run.log;
  };
  const Json point{{0.0, 0.0}};
  for (const auto& [message, words] : std::vector<std::pair<Json, std::string>>{
           {trajectory({{0.0}}, {"x"}), "says nothing of joint 'y' of robot 'point'"},
           {trajectory({{0.0, 0.0, 0.0}}, {"x", "y", "z"}),
            "has values of joint 'z', which robot 'point' does not"},
           {trajectory({{0.0, 0.0}}, {"x", "x"}), "joint_names: expected each name once"},
           {trajectory({{0.0, 0.0, 1.0}}), "points[0].positions"},
           {trajectory({{0.0, "a"}}), "points[0].positions"},
           {trajectory(Json::array()), "points: expected at least one"},
           {Json{{"trajectory", Json::array()}, {"x", {{"joint_names", 1}}}}, "expected at least one"},
           {Json{{"joint_trajectory", trajectory(point)},
                 {"multi_dof_joint_trajectory", {{"joint_names", {"base"}}, {"points", {{{"a", 1}}}}}}},
            "the robot's base stands still"},
           {Json{{"joint_trajectory", trajectory(point)}, {"joint_names", {"x"}}}, "got both"},
           {Json{{"trajectory", {{{"joint_trajectory", trajectory(point)}}}},
                 {"trajectory_start", {{"attached_collision_objects", {{{"link_name", "a"}}}}}}},
            "--attach says what the robot carries"}})
    EXPECT_NE(refusal(message).find(words), std::string::npos) << refusal(message);
  const CommandRun run = check_file("t.yaml", "a: 1\n");
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("joint_names"), std::string::npos) << run.log;
}

/// As programs write a limit that reckon in single precision, with times and without.
TEST_F(CheckTrajectory, ValuesAtALimitMayBeRounded) {
  const std::string limited = folder_.write(
      "limited.urdf",
      "<robot name='limited'><link name='world'/><link name='slide'/><link name='base'><collision><geometry>"
      "<sphere radius='0.1'/></geometry></collision></link>"
      "<joint name='x' type='prismatic'><parent link='world'/><child link='slide'/><axis xyz='1 0 0'/>"
      "<limit lower='-0.3' upper='0.3' effort='1' velocity='1'/></joint>"
      "<joint name='y' type='prismatic'><parent link='slide'/><child link='base'/><axis xyz='0 1 0'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>");
  for (const double time : {0.0, 4.0}) {
    const auto checked = [&](double x) {
      Json message = trajectory({{-0.3, 0.0}, {x, 0.1}});
      message["points"][1]["time_from_start"]["sec"] = time;
      return run_command({"check", folder_.write("limit.json", message.dump()), "--map", folder_.file("map"),
                          "--robot", limited, "--policy", "not_occupied"});
    };
    const CommandRun rounded = checked(0.3F);
    EXPECT_EQ(rounded.status, exit_done) << rounded.out << rounded.log;
    EXPECT_NE(rounded.out.find("joint x is beyond its limit by up to 1.19e-08"), std::string::npos)
        << rounded.out;
    const CommandRun beyond = checked(0.3000002);
    EXPECT_EQ(beyond.status, exit_no);
    EXPECT_NE(beyond.out.find("joint x is 0.3000002, outside its limits -0.3 to 0.3"), std::string::npos)
        << beyond.out;
  }
}

TEST_F(CheckTrajectory, JointsThatStandStillMayBeInItWhereTheyStand) {
  const std::string urdf = folder_.write("arm.urdf", worlds::arm_with_finger());
  const Robot robot = load_robot(RobotRequest{urdf, {}, {}, {{"grip", 0.03}}});
  const ForeignTrajectory still{{"grip", "elbow", "shoulder"}, {{0.03, 0.1, 0.2}, {0.03005, 0.3, 0.4}}};
  const Plan plan = plan_of_trajectory(still, robot, "t.json");
  EXPECT_EQ(plan.waypoints().back(), Configuration(Eigen::Vector2d(0.4, 0.3)));
  const ForeignTrajectory moves{{"grip", "elbow", "shoulder"}, {{0.03, 0.1, 0.2}, {0.05, 0.3, 0.4}}};
  EXPECT_THROW(plan_of_trajectory(moves, robot, "t.json"), std::invalid_argument);
  ForeignTrajectory started = still;
  started.start = {{"elbow", -0.5}, {"grip", 0.03}};
  const Plan longer = plan_of_trajectory(started, robot, "t.json");
  EXPECT_EQ(longer.start, Configuration(Eigen::Vector2d(0.2, -0.5)));
  EXPECT_EQ(longer.waypoints().size(), 3U);
  started.start["grip"] = 0.01;
  EXPECT_THROW(plan_of_trajectory(started, robot, "t.json"), std::invalid_argument);
  EXPECT_THROW(plan_of_trajectory(still, scaled(robot, 0.5), "t.json"), std::invalid_argument);
}

/// The arm with a second finger whose joint follows grip.
std::string with_follower(const std::string& axis, const std::string& mimic) {
  std::string text = worlds::arm_with_finger();
  return text.replace(text.find("</robot>"), std::string::npos,
                      worlds::urdf_link("other", "0.1 0 0", "<sphere radius='0.05'/>") +
                          worlds::urdf_joint("follower", "prismatic", "lower", "other", "0.4 0.2 0", axis,
                                             worlds::urdf_limit(0, 0.1) + mimic) +
                          "</robot>");
}

/// As fingers of many grippers, against its master's axis: its values are those of its own joint.
TEST_F(CheckTrajectory, AFollowerAgainstItsMastersAxisHasItsOwnValues) {
  for (const char* axis : {"1 0 0", "-1 0 0", "0 1 0"}) {
    const Robot robot = load_robot(folder_.write("arm.urdf", with_follower(axis, "<mimic joint='grip'/>")));
    ForeignTrajectory trajectory{{"follower", "grip", "elbow", "shoulder"},
                                 {{0.0, 0.0, 0.1, 0.2}, {0.03, 0.03, 0.3, 0.4}}};
    EXPECT_NO_THROW(plan_of_trajectory(trajectory, robot, "t.json")) << axis;
    trajectory.points[1][0] = -0.03;
    EXPECT_THROW(plan_of_trajectory(trajectory, robot, "t.json"), std::invalid_argument) << axis;
  }
}

/// A second finger at 0.08 - 0.5 grip: a controller may be given it, too, where grip takes it.
TEST_F(CheckTrajectory, JointsThatFollowOthersMayBeInItWhereTheseTakeThem) {
  const Robot robot = load_robot(folder_.write(
      "arm.urdf", with_follower("1 0 0", "<mimic joint='grip' multiplier='-0.5' offset='0.08'/>")));
  ForeignTrajectory trajectory{{"follower", "grip", "elbow", "shoulder"},
                               {{0.08, 0.0, 0.1, 0.2}, {0.05, 0.06, 0.3, 0.4}}};
  trajectory.times = {0.0, 1.0};
  trajectory.velocities = {{-0.01, 0.02, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  trajectory.accelerations = {{0.2, -0.4, 0.0, 0.0}, {}};
  const Plan plan = plan_of_trajectory(trajectory, robot, "t.json");
  EXPECT_EQ(plan.waypoints().back(), Configuration(Eigen::Vector3d(0.4, 0.3, 0.06)));
  const auto timed = timed_trajectory(trajectory, robot, "t.json");
  ASSERT_TRUE(timed);
  EXPECT_EQ(timed->points[0].velocity, Eigen::VectorXd(Eigen::Vector3d(0.0, 0.0, 0.02)));
  const auto refusal = [&](std::vector<double>& values, double value) -> std::string {
    const double right = std::exchange(values[0], value);
    std::string sentence;
    try {
      plan_of_trajectory(trajectory, robot, "t.json");
    } catch (const std::invalid_argument& error) {
      sentence = error.what();
    }
    values[0] = right;
    return sentence;
  };
  EXPECT_EQ(refusal(trajectory.points[1], 0.06),
            "t.json: the trajectory has joint 'follower' at 0.06, which stands at 0.05, as it follows 'grip' "
            "(mimic), expected that, or the joint left out");
  EXPECT_NE(refusal(trajectory.velocities[0], 0.0).find("moves at -0.01"), std::string::npos);
  EXPECT_NE(refusal(trajectory.accelerations[0], 0.0).find("is accelerated at 0.2"), std::string::npos);
  EXPECT_EQ(refusal(trajectory.points[1], 0.05005), "");
}

/// As MoveIt's trajectory_start has all joints of the robot.
TEST_F(CheckTrajectory, AJointThatFollowsAnotherStandsBeforeItWhereThatTakesIt) {
  const Robot robot = load_robot(folder_.write(
      "arm.urdf", with_follower("1 0 0", "<mimic joint='grip' multiplier='-0.5' offset='0.08'/>")));
  const Json points = trajectory({{0.06, 0.1, 0.2}, {0.02, 0.3, 0.4}}, {"grip", "elbow", "shoulder"});
  const auto said_of = [&](const Json& names, const Json& values) -> std::string {
    Json again = points;  // a second one, when the follower has moved
    again["points"] = {points["points"][1], points["points"][0]};
    const Json file{{"trajectory_start", {{"joint_state", {{"name", names}, {"position", values}}}}},
                    {"trajectory", {{{"joint_trajectory", points}}, {{"joint_trajectory", again}}}}};
    try {
      const std::string name = folder_.write("t.json", file.dump());
      plan_of_trajectories(read_trajectories(name), robot, "t.json");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said_of({"grip", "elbow", "shoulder", "follower"}, {0.06, 0.1, 0.2, 0.05}), "");
  EXPECT_EQ(said_of({"follower"}, {0.05}), "");
  EXPECT_EQ(said_of({"grip", "follower"}, {0.02, 0.07}), "") << "grip comes from 0.02 to the first point";
  EXPECT_NE(said_of({"grip", "follower"}, {0.02, 0.05}), "");
  for (const std::string& said : {said_of({"grip", "elbow", "shoulder", "follower"}, {0.06, 0.1, 0.2, 0.08}),
                                  said_of({"follower"}, {0.08})})
    EXPECT_NE(
        said.find("has joint 'follower' at 0.08, which stands before it (trajectory_start) at 0.05, as it "
                  "follows 'grip' (mimic)"),
        std::string::npos)
        << said;
}

TEST_F(CheckTrajectory, ValuesThatLookLikeDegreesAreTold) {
  const auto log_of = [&](const Json& points) {
    const Json message = trajectory(points, {"shoulder", "elbow"});
    return run_command({"check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"),
                        "--robot", "planar2", "--policy", "not_occupied", "--allow-outside", "all"})
        .log;
  };
  EXPECT_NE(
      log_of({{0.0, 0.1}, {90.0, -45.0}})
          .find(
              "the trajectory's waypoint 2 is far outside of the joint limits in radians and within them in "
              "degrees: expected radians"),
      std::string::npos);
  EXPECT_EQ(log_of({{0.0, 0.1}, {1.0, -0.5}}).find("degrees"), std::string::npos);
  EXPECT_EQ(log_of({{0.0, 0.1}, {900.0, -0.5}}).find("degrees"), std::string::npos);
}

/// A whole turn of a joint without limits leads to the same pose; of one with limits it is another place.
TEST_F(CheckTrajectory, AStartThatIsAWholeTurnOffIsTheSameOfAJointWithoutLimits) {
  const auto check_turn = [&](const std::string& kind, const std::string& start) {
    const std::string ball = "<sphere radius='0.05'/>",
                      urdf = folder_.write(
                          "turn.urdf", "<robot name='turn'>" + worlds::urdf_link("base", "0 0 0", ball) +
                                           worlds::urdf_link("arm", "0.3 0 0", ball) +
                                           worlds::urdf_joint("wheel", kind, "base", "arm", "0 0 0", "0 0 1",
                                                              worlds::urdf_limit(-9, 9)) +
                                           "</robot>");
    const Json points = trajectory({{0.2}, {0.5}}, {"wheel"});
    return run_command({"check", folder_.write("turn.json", points.dump()), "--map", folder_.file("map"),
                        "--robot", urdf, "--policy", "not_occupied", "--allow-outside", "all",
                        "--start=" + start});
  };
  const CommandRun turned = check_turn("continuous", "6.4831853071795862");
  EXPECT_EQ(turned.status, exit_done) << turned.out << turned.log;
  EXPECT_NE(
      turned.out.find("the start of joint wheel, 6.483 rad, counts as 0.2 rad: the joint has no limits"),
      std::string::npos)
      << turned.out;
  EXPECT_EQ(check_turn("continuous", "-6.0831853071795867").status, exit_done);
  const CommandRun same = check_turn("continuous", "0.2");
  EXPECT_EQ(same.status, exit_done);
  EXPECT_EQ(same.out.find("the start of joint"), std::string::npos);
  EXPECT_EQ(check_turn("continuous", "3.3415926535897931").status, exit_no) << "half a turn";
  EXPECT_EQ(check_turn("revolute", "6.4831853071795862").status, exit_no);
  // Nor does a turn lead past the query's own record to that of another.
  const auto query = [](const char* name, double start) {
    return QueryTerms{.name = name,
                      .robot = "turn",
                      .scale = 1.0,
                      .map_from_base = Eigen::Isometry3d::Identity(),
                      .policies = {{"base", Policy::not_occupied}, {"arm", Policy::not_occupied}},
                      .padding = 0.001,
                      .start = Configuration::Constant(1, start),
                      .goals = {Configuration::Constant(1, 0.5)}};
  };
  folder_.write("map/queries.json", to_json(QueryRecord{map_sha256(folder_.path() / "map"),
                                                        {query("strict", 0.2), query("loose", 1.0)}}));
  EXPECT_NE(check_turn("continuous", "1.0").out.find("'loose'"), std::string::npos);  // another start is
  EXPECT_NE(check_turn("continuous", "6.4831853071795862").out.find("'strict'"), std::string::npos)
      << check_turn("continuous", "6.4831853071795862").out;
}

TEST_F(CheckTrajectory, APlanWithItsJointsInAnotherOrderIsTheSamePlan) {
  Json plan = plan_;
  const auto swap = [](Json& q) { std::swap(q[0], q[1]); };
  swap(plan["joints"]);
  swap(plan["start"]);
  for (const char* key : {"waypoints", "goals"})
    for (Json& q : plan[key]) swap(q);
  const CommandRun run = check(plan, {"--json"}), own = check(plan_, {"--json"});
  EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_EQ(Json::parse(run.out), Json::parse(own.out));
  plan["joints"][0] = "z";
  EXPECT_EQ(check(plan).status, exit_bad_input);
}

}  // namespace check_test
}  // namespace clearway
