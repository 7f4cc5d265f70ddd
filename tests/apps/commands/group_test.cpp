// Planning groups, held joints and named states on the command line, and what `check` makes of them.
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace group_test {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

/// An arm of two joints with a gripper that slides, without masses, in a map of one occupied voxel far away.
class Group : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("arm.urdf", worlds::arm_with_finger());
    folder_.write(
        "arm.srdf",
        "<robot name='arm'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
        "<group_state name='home' group='arm'><joint name='shoulder' value='0'/>"
        "<joint name='elbow' value='0.1'/></group_state>"
        "<group_state name='ready' group='arm'><joint name='shoulder' value='0.5'/>"
        "<joint name='elbow' value='-0.1'/></group_state>"
        "<end_effector name='gripper' parent_link='finger' group='hand' parent_group='arm'/>"
        "<group_state name='half' group='arm'><joint name='elbow' value='-0.1'/></group_state></robot>");
    FreeSpaceMap map({.resolution = 0.05});
    Scan scan;
    scan.points = {{3.0F, 3.0F, 3.0F}};
    map.insert(scan);
    save_map(map.snapshot(), folder_.path() / "map");
  }

  CommandRun plan(const Arguments& more) const {
    Arguments arguments{
        "plan",         "--map",     folder_.file("map"), "--robot", folder_.file("arm.urdf"), "--policy",
        "not_occupied", "--planner", "rrtconnect",        "--out",   folder_.file("plan.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  CommandRun check(const Arguments& more = {}) const {
    Arguments arguments{"check",
                        "--json",
                        "--map",
                        folder_.file("map"),
                        "--robot",
                        folder_.file("arm.urdf"),
                        "--policy",
                        "not_occupied",
                        folder_.file("plan.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  Json written() const { return Json::parse(read_file(folder_.file("plan.json"))); }

  TemporaryFolder folder_;
};

TEST_F(Group, PlansInItsOwnJointsBetweenNamedStatesAndSaysWhereTheOthersStood) {
  const CommandRun run = plan({"--group", "arm", "--fix", "grip=0.03", "--start", "home", "--goal", "ready",
                               "--trajectory", "ros", folder_.file("motion.yaml")});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json plan = written();
  EXPECT_EQ(plan["joints"], Json({"shoulder", "elbow"}));
  EXPECT_EQ(plan["group"], "arm");
  EXPECT_EQ(plan["held"], Json({{"grip", 0.03}}));
  EXPECT_EQ(plan["waypoints"].front(), Json({0.0, 0.1}));
  EXPECT_EQ(plan["waypoints"].back(), Json({0.5, -0.1}));
  const std::string motion = read_file(folder_.file("motion.yaml"));
  EXPECT_NE(motion.find("elbow"), std::string::npos);
  EXPECT_NE(motion.find("# held: \"grip\" at "), std::string::npos);
  EXPECT_EQ(motion.find("grip", motion.find("joint_names")), std::string::npos);
  EXPECT_NE(run.out.find("not known: The robot's file gives link 'lower' and 1 other that move no mass"),
            std::string::npos)
      << run.out;
  const CommandRun loaded =
      this->plan({"--group", "arm", "--start", "home", "--goal", "ready", "--payload", "2"});
  EXPECT_NE(loaded.out.find("not known: The robot's file"), std::string::npos) << loaded.out;
}

TEST_F(Group, AWheelThatStandsOnItsFloorIsNamedAndOnlyByTheUser) {
  std::string urdf = worlds::arm_with_finger();
  urdf.insert(urdf.rfind("</robot>"),
              "<link name='wheel'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
              "<joint name='axle' type='continuous'><parent link='base'/><child link='wheel'/>"
              "<origin xyz='-1 0 0'/><axis xyz='0 1 0'/></joint>");
  folder_.write("arm.urdf", urdf);
  FreeSpaceMap map({.resolution = 0.05});
  Scan scan;
  scan.points = {{-1.0F, 0.0F, -0.08F}};
  map.insert(scan);
  save_map(map.snapshot(), folder_.path() / "map");
  const Arguments query{"--group", "arm", "--start", "home", "--goal", "ready", "--allow-outside", "all"};
  const auto with = [&](Arguments arguments) {
    arguments.insert(arguments.begin(), query.begin(), query.end());
    return arguments;
  };
  const CommandRun held = plan(query);
  EXPECT_EQ(held.status, exit_no);
  EXPECT_NE(held.out.find("wheel touches an occupied voxel"), std::string::npos) << held.out;
  EXPECT_NE(held.log.find("--standing wheel lets it touch the map"), std::string::npos) << held.log;
  const CommandRun standing = plan(with({"--standing", "wheel"}));
  EXPECT_EQ(standing.status, exit_done) << standing.out << standing.log;
  EXPECT_NE(standing.out.find("wheel"), std::string::npos) << standing.out;
  EXPECT_EQ(check({"--allow-outside", "all"}).status, exit_no);
  const CommandRun checked = check({"--allow-outside", "all", "--standing", "wheel"});
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  EXPECT_EQ(Json::parse(checked.out)["standing_in_occupied"][0]["part"], "wheel") << checked.out;
  EXPECT_EQ(check({"--allow-outside", "all", "--standing", "wheel", "--strict"}).status, exit_no);
  for (const char* link : {"whel", "lower"}) {
    const CommandRun refused = plan(with({"--standing", link}));
    EXPECT_EQ(refused.status, exit_bad_input);
    EXPECT_TRUE(refused.complains_in_one_sentence()) << refused.log;
  }
  folder_.write("arm.yaml", "standing: [wheel]\n");
  EXPECT_EQ(check({"--allow-outside", "all"}).status, exit_done);
  const CommandRun whole = plan({"--start", "0,0.1,0,0", "--goal", "0.5,-0.1,0,0", "--allow-outside", "all"});
  EXPECT_NE(whole.out.find("wheel touches an occupied voxel"), std::string::npos)
      << whole.out;  // it moves then
}

TEST_F(Group, AGoalThatTurnsAnEndlessJointFartherThanItHasToIsTold) {
  std::string urdf = worlds::arm_with_finger();
  urdf.insert(urdf.rfind("</robot>"),
              "<link name='wrist'/><joint name='roll' type='continuous'><parent link='lower'/>"
              "<child link='wrist'/><axis xyz='1 0 0'/></joint>");
  folder_.write("arm.urdf", urdf);
  std::filesystem::remove(folder_.path() / "arm.srdf");
  const CommandRun far = plan({"--start", "0,0.1,0,-3", "--goal", "0,0.1,0,3"});
  EXPECT_EQ(far.status, exit_done) << far.out << far.log;
  EXPECT_NE(far.log.find("joint roll turns without limits and is led from -3 to 3 rad, as the goal says; "
                         "-3.283 rad is the same place"),
            std::string::npos)
      << far.log;
  EXPECT_EQ(plan({"--start", "0,0.1,0,-3", "--goal", "0,0.1,0,-2"}).log.find("without limits"),
            std::string::npos);
}

TEST_F(Group, TheCheckStatesGroupAndHeldJointsWithTheirSource) {
  ASSERT_EQ(plan({"--group", "arm", "--fix", "grip=0.03", "--start", "home", "--goal", "ready"}).status,
            exit_done);
  const CommandRun by_plan = check();
  EXPECT_EQ(by_plan.status, exit_done) << by_plan.out << by_plan.log;
  Json contract = Json::parse(by_plan.out)["contract"];
  EXPECT_EQ(contract["group"], Json({{"value", "arm"}, {"source", "plan"}}));
  EXPECT_EQ(contract["held"]["grip"], Json({{"value", 0.03}, {"source", "plan"}}));
  const CommandRun by_flag = check({"--group", "arm", "--fix", "grip=0.03", "--goal", "ready"});
  EXPECT_EQ(by_flag.status, exit_done) << by_flag.out << by_flag.log;
  contract = Json::parse(by_flag.out)["contract"];
  EXPECT_EQ(contract["group"], Json({{"value", "arm"}, {"source", "flag"}}));
  EXPECT_EQ(contract["held"]["grip"], Json({{"value", 0.03}, {"source", "flag"}}));
}

TEST_F(Group, APlanThatHoldsAJointElsewhereThanTheUserSaysIsRefused) {
  ASSERT_EQ(plan({"--group", "arm", "--fix", "grip=0.03", "--start", "home", "--goal", "ready"}).status,
            exit_done);
  const CommandRun elsewhere = check({"--group", "arm", "--fix", "grip=0.05"});
  EXPECT_EQ(elsewhere.status, exit_no);
  EXPECT_NE(elsewhere.out.find("joint grip: expected to stand at 0.05, the plan says 0.03"),
            std::string::npos)
      << elsewhere.out;
  EXPECT_EQ(check({"--group", "arm", "--fix", "grip=0.05", "--accept-held"}).status, exit_done);
  folder_.write("arm.yaml", "fixed: {grip: 0.07}\n");
  EXPECT_EQ(check().status, exit_no);
  folder_.write("arm.yaml", "description: nothing fixed\n");
  Json edited = written();
  edited["held"]["grip"] = 0.5;  // out of its limits
  folder_.write("plan.json", edited.dump());
  const CommandRun outside = check();
  EXPECT_EQ(outside.status, exit_bad_input);
  EXPECT_TRUE(outside.complains_in_one_sentence()) << outside.log;
  edited["held"] = {{"grap", 0.01}};
  folder_.write("plan.json", edited.dump());
  EXPECT_TRUE(check().complains_in_one_sentence());
}

/// The other joints, as a second arm's, stand where a state of theirs says; values of their own go before.
TEST_F(Group, JointsOutsideOfTheGroupStandWhereAStateHasThem) {
  const std::string srdf = read_file(folder_.file("arm.srdf"));
  const std::string hand =
      "<group name='hand'><joint name='grip'/></group><group_state name='open' group='hand'>"
      "<joint name='grip' value='0.04'/><joint name='elbow' value='1'/></group_state></robot>";
  folder_.write("arm.srdf", srdf.substr(0, srdf.find("</robot>")) + hand);
  const auto held = [&](const Arguments& fixed) {
    Arguments arguments{"--group", "arm", "--start", "home", "--goal", "ready"};
    arguments.insert(arguments.end(), fixed.begin(), fixed.end());
    EXPECT_EQ(plan(arguments).status, exit_done);
    return Json::parse(read_file(folder_.file("plan.json")))["held"];
  };
  EXPECT_EQ(held({"--fix", "open"}), Json({{"grip", 0.04}}));
  EXPECT_EQ(held({"--fix", "open", "--fix", "grip=0.01"}), Json({{"grip", 0.01}}));
  EXPECT_EQ(held({}), Json({{"grip", 0.0}}));
  const CommandRun elsewhere = check({"--group", "arm", "--fix", "open"});  // the plan's is at 0
  EXPECT_EQ(elsewhere.status, exit_no);
  const Json term = Json::parse(elsewhere.out)["contract"]["held"]["grip"];
  EXPECT_EQ(term["value"], 0.04) << elsewhere.out;
  EXPECT_EQ(term["source"], "flag") << elsewhere.out;
  held({"--fix", "open"});
  EXPECT_EQ(check({"--group", "arm", "--fix", "open"}).status, exit_done);
  const CommandRun unknown = plan({"--group", "arm", "--fix", "opn", "--start", "home", "--goal", "ready"});
  EXPECT_EQ(unknown.status, exit_bad_input);
  EXPECT_NE(unknown.log.find("did you mean 'open'?"), std::string::npos) << unknown.log;
}

/// How often a file was opened since then.
class Openings {
 public:
  explicit Openings(const std::string& file) : events_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    inotify_add_watch(events_, file.c_str(), IN_OPEN | IN_CLOSE);  // like events in a row would be one
  }
  ~Openings() { close(events_); }
  Openings(const Openings&) = delete;
  Openings& operator=(const Openings&) = delete;
  int count() const {
    int opened = 0;
    for (inotify_event event{}; read(events_, &event, sizeof(event)) == sizeof(event);)
      if ((event.mask & IN_OPEN) != 0) ++opened;
    return opened;
  }

 private:
  int events_;
};

/// A robot with its meshes takes seconds to load.
TEST_F(Group, TheRobotIsLoadedAsOftenForManyHeldJointsAsForOne) {
  const std::string sphere = "<sphere radius='0.02'/>";
  const auto opened = [&](int fingers) {
    std::string robot = worlds::arm_with_finger(), state;
    robot.resize(robot.find("</robot>"));
    for (int i = 0; i < fingers; ++i) {
      const std::string name = "f" + std::to_string(i), y = std::to_string(0.2 * (i + 1));
      robot += worlds::urdf_link(name, "0 0 0", sphere) + worlds::urdf_joint("j" + name, "revolute", "base",
                                                                             name, "0 " + y + " 1", "0 0 1",
                                                                             worlds::urdf_limit(-2, 2));
      state += "<joint name='j" + name + "' value='0.1'/>";
    }
    folder_.write("many.urdf", robot + "</robot>");
    folder_.write("many.srdf",
                  "<robot name='arm'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
                  "<group name='rest'><joint name='grip'/></group><group_state name='open' "
                  "group='rest'>" +
                      state + "</group_state></robot>");
    const Arguments of{"--map",    folder_.file("map"),
                       "--robot",  folder_.file("many.urdf"),
                       "--policy", "not_occupied",
                       "--group",  "arm",
                       "--fix",    "open"};
    Arguments plans{"plan", "--start", "0,0.1", "--goal", "0.5,-0.1", "--out", folder_.file("many.json")},
        checks{"check", folder_.file("many.json")};
    plans.insert(plans.end(), of.begin(), of.end());
    checks.insert(checks.end(), of.begin(), of.end());
    EXPECT_EQ(run_command(plans).status, exit_done);
    const Openings openings(folder_.file("many.urdf"));
    EXPECT_EQ(run_command(checks).status, exit_done);
    return openings.count();
  };
  const int once = opened(1);
  EXPECT_GT(once, 0);
  EXPECT_EQ(opened(6), once);
}

TEST_F(Group, StatesThatContradictEachOtherFixNothing) {
  const std::string srdf = read_file(folder_.file("arm.srdf"));
  const auto state = [](const std::string& name, const std::string& group, const std::string& value) {
    return "<group_state name='" + name + "' group='" + group + "'><joint name='grip' value='" + value +
           "'/></group_state>";
  };
  folder_.write("arm.srdf", srdf.substr(0, srdf.find("</robot>")) +
                                "<group name='hand'><joint name='grip'/></group>" +
                                state("open", "hand", "0.04") + state("wide", "hand", "0.04") +
                                state("shut", "hand", "0") + state("shut", "arm", "0.01") + "</robot>");
  const auto told = [&](Arguments arguments) {
    for (const char* word : {"--start", "home", "--goal", "ready"}) arguments.emplace_back(word);
    const CommandRun run = plan(arguments);
    EXPECT_EQ(run.status == exit_done, run.log.empty()) << run.log;
    EXPECT_TRUE(run.status == exit_done || run.complains_in_one_sentence()) << run.log;
    return run.log;
  };
  const Arguments alike{"--group", "arm", "--fix", "open", "--fix", "wide"};
  Arguments other{"--group", "arm", "--fix", "open", "--fix", "shut"};
  EXPECT_EQ(told(alike), "");
  EXPECT_NE(
      told(other).find("--fix: states 'open' of group 'hand' and 'shut' of group 'hand' have joint 'grip' "
                       "at 0.04 and at 0, expected one of them or --fix grip=VALUE"),
      std::string::npos);
  EXPECT_NE(
      told({"--group", "arm", "--fix", "shut"}).find("'shut' of group 'hand' and 'shut' of group 'arm'"),
      std::string::npos);
  other.insert(other.end(), {"--fix", "grip=0.02"});
  EXPECT_EQ(told(other), "");
  EXPECT_NE(told({"--fix", "home", "--fix", "open"})
                .find("--fix: every joint is fixed, expected at least one that moves (--group)"),
            std::string::npos);
}

/// As MoveIt takes them: at the start joints rest, at a goal they stay where they are.
TEST_F(Group, AStateOfSomeJointsLeavesTheOthersWhereTheyAre) {
  const auto planned = [&](const Arguments& stops) {
    Arguments arguments{"--group", "arm"};
    arguments.insert(arguments.end(), stops.begin(), stops.end());
    const CommandRun run = plan(arguments);
    EXPECT_EQ(run.status, exit_done) << run.log;
    const Json json = Json::parse(read_file(folder_.file("plan.json")));
    return std::pair(Json{json["start"], json["goals"]}, run.log);
  };
  const auto [late, said] = planned({"--start", "home", "--goal", "0.5,0.3", "--goal", "half"});
  EXPECT_EQ(late, Json::parse("[[0.0, 0.1], [[0.5, 0.3], [0.5, -0.1]]]"));
  EXPECT_NE(said.find("note: --goal: state 'half' does not name joint shoulder (0.5), which stays where the "
                      "stop before has it"),
            std::string::npos)
      << said;
  EXPECT_EQ(check({"--group", "arm", "--goal", "0.5,0.3", "--goal", "half"}).status, exit_done);
  EXPECT_EQ(check({"--group", "arm", "--goal", "half", "--goal", "half"}).status, exit_no)
      << "from shoulder 0";
  const auto [early, told] = planned({"--start", "half", "--goal", "ready"});
  EXPECT_EQ(early, Json::parse("[[0.0, -0.1], [[0.5, -0.1]]]"));
  EXPECT_NE(told.find("--start: state 'half' does not name joint shoulder (0), which stays where the robot "
                      "rests"),
            std::string::npos)
      << told;
  const std::string srdf = read_file(folder_.file("arm.srdf"));
  folder_.write("arm.srdf", srdf.substr(0, srdf.find("</robot>")) +
                                "<group_state name='default' group='arm'><joint name='shoulder' "
                                "value='0.4'/></group_state></robot>");
  EXPECT_EQ(planned({"--start", "half", "--goal", "ready"}).first[0], Json::parse("[0.4, -0.1]"));
}

TEST_F(Group, WhatCannotBeReadIsReportedInOneSentence) {
  const auto expect_refused = [&](const Arguments& more, const std::string& expected) {
    const CommandRun run = plan(more);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(expected), std::string::npos) << run.log;
  };
  expect_refused({"--group", "arm", "--start", "hom", "--goal", "ready"}, "half, home, ready");
  expect_refused({"--fix", "grip", "--start", "home", "--goal", "ready"},
                 "--fix: expected JOINT=VALUE or a state of a SRDF, got 'grip'");
  expect_refused({"--fix", "grip=x", "--start", "home", "--goal", "ready"},
                 "--fix 'grip': 'x' is not a finite number");
  expect_refused({"--fix", "grip=0", "--fix", "grip=0", "--start", "home", "--goal", "ready"}, "given twice");
  expect_refused({"--srdf", folder_.file("no.srdf"), "--start", "home", "--goal", "ready"}, "no.srdf");
  expect_refused({"--package", "a", "--start", "home", "--goal", "ready"},
                 "--package: expected NAME=DIR, got 'a'");
  for (const char* text : {"side", "side=left", ":=left", "si-de:=left"})
    expect_refused({"--xacro", text, "--start", "home", "--goal", "ready"},
                   "--xacro: expected NAME:=VALUE with a name of letters, digits and underscores, got '" +
                       std::string(text) + "'");
  expect_refused({"--xacro", "side:=left", "--xacro", "side:=", "--start", "home", "--goal", "ready"},
                 "--xacro: argument 'side' is given twice");
  expect_refused({"--xacro", "side:=left", "--start", "home", "--goal", "ready"}, "is no .xacro file");
}

/// A stand-in for xacro, which makes the robot for one argument alone.
TEST_F(Group, ArgumentsOfXacroReachTheProgramFromPlanAndCheck) {
  const std::string program =
      folder_.write("xacro", "#!/bin/sh\n[ \"$2\" = side:=left ] && cat " + folder_.file("made.urdf") + "\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  std::filesystem::rename(folder_ / "arm.urdf", folder_ / "made.urdf");
  folder_.write("arm.urdf.xacro", "<robot name='arm'/>");
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  ::setenv("PATH", (folder_.path().string() + ":/usr/bin:/bin").c_str(), 1);
  const Arguments robot{"--map",    folder_.file("map"), "--robot", folder_.file("arm.urdf.xacro"),
                        "--policy", "not_occupied",      "--group", "arm"};
  Arguments plan{"plan",    "--planner", "rrtconnect", "--out", folder_.file("plan.json"),
                 "--start", "home",      "--goal",     "ready"};
  Arguments check{"check", folder_.file("plan.json")};
  for (Arguments* arguments : {&plan, &check})
    arguments->insert(arguments->end(), robot.begin(), robot.end());
  const CommandRun without = run_command(plan);
  EXPECT_EQ(without.status, exit_bad_input);
  EXPECT_NE(without.log.find("--xacro NAME:=VALUE"), std::string::npos) << without.log;
  for (Arguments* arguments : {&plan, &check}) {
    arguments->insert(arguments->end(), {"--xacro", "side:=left"});
    const CommandRun with = run_command(*arguments);
    EXPECT_EQ(with.status, exit_done) << with.out << with.log;
    EXPECT_EQ(with.out.find("other xacro arguments"), std::string::npos) << with.out;
  }
  EXPECT_EQ(written()["xacro"], (Json{{"side", "left"}}));
  folder_.write("xacro", "#!/bin/sh\ncat " + folder_.file("made.urdf") + "\n");  // whatever is asked
  check.resize(check.size() - 2);
  const CommandRun other = run_command(check);
  EXPECT_NE((other.out + other.log)
                .find("other xacro arguments (side:=left) than those of the robot that is "
                      "checked (none)"),
            std::string::npos)
      << other.out << other.log;
  ::setenv("PATH", before.c_str(), 1);
}

TEST_F(Group, APoseOfTheTipIsReachedWithinTheGroupAndCheckedAsAnyGoal) {
  // With the shoulder at 0.5 and the elbow at -0.1 the finger's joint is 0.4 m ahead of the elbow.
  const double x = 0.4 * std::cos(0.5) + 0.4 * std::cos(0.4), y = 0.4 * std::sin(0.5) + 0.4 * std::sin(0.4);
  const std::string pose = std::to_string(x) + "," + std::to_string(y) + ",0,0,0,0.4";
  const CommandRun run =
      plan({"--fix", "grip=0", "--start", "home", "--tip", "finger", "--goal-pose=" + pose});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json goal = written()["goals"][0];
  ASSERT_EQ(plan({"--fix", "grip=0", "--start", "home", "--tip", "gripper", "--goal-pose=" + pose}).status,
            exit_done);
  EXPECT_EQ(written()["goals"][0], goal);
  EXPECT_NEAR(goal[0].get<double>(), 0.5, 1e-4);
  EXPECT_NEAR(goal[1].get<double>(), -0.1, 1e-4);
  EXPECT_EQ(check().status, exit_done);
  const CommandRun far = plan({"--start", "0,0,0", "--goal-pose=5,0,0"});
  EXPECT_EQ(far.status, exit_no) << far.log;
  EXPECT_NE(far.out.find("goal_invalid"), std::string::npos) << far.out;
  EXPECT_EQ(plan({"--start", "0,0,0", "--goal", "0,0,0", "--goal-pose=5,0,0"}).status, exit_bad_input);
  EXPECT_EQ(plan({"--start", "0,0,0", "--goal-pose=5,0,0", "--tip", "fingr"}).status, exit_bad_input);
}

TEST_F(Group, ValuesThatMustBeDegreesAreRefused) {
  const CommandRun run = plan({"--group", "arm", "--start=90,-45", "--goal=0,0"});
  EXPECT_NE(run.status, exit_done);
  EXPECT_NE(run.log.find("--degrees reads it so"), std::string::npos) << run.log;
  EXPECT_EQ(plan({"--group", "arm", "--start=2.5,0", "--goal=0,0"}).log.find("--degrees"), std::string::npos);
  ASSERT_EQ(plan({"--group", "arm", "--start=0,0", "--goal=0.5,0.1"}).status, exit_done);
  for (const char* flag : {"--start", "--goal"}) {
    const CommandRun checked = check({"--group", "arm", std::string(flag) + "=28.6,5.7"});
    EXPECT_NE(
        checked.log.find("note: " + std::string(flag) + " is far outside of the joint limits in radians"),
        std::string::npos)
        << checked.log;
  }
  EXPECT_EQ(check({"--group", "arm", "--goal=28.65,5.73", "--degrees"}).log.find("reads it so"),
            std::string::npos);
}

/// A SRDF that was not made for this robot: its pairs may be meant for other links.
TEST_F(Group, ASrdfOfAnotherRobotIsTold) {
  folder_.write("arm.srdf",
                "<robot name='leg'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
                "<disable_collisions link1='upper' link2='hand'/></robot>");
  const CommandRun run =
      run_command({"plan", "--map", folder_.file("map"), "--robot", folder_.file("arm.urdf"), "--group",
                   "arm", "--policy", "not_occupied", "--start=0,0", "--goal=0.2,0"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.log.find("arm.srdf' is for robot 'leg', the URDF's robot is called 'arm'\n"),
            std::string::npos)
      << run.log;
  EXPECT_NE(run.log.find("names 1 link in pairs without a test that the robot does not have: hand\n"),
            std::string::npos)
      << run.log;
}

}  // namespace group_test
}  // namespace clearway
