// Goals that are poses, from the flags of `plan` and from a setup's queries.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace goal_pose_test {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

const char* const start = "-0.8,0.5,0,-1.8,0,2.3,0";

/// A post before a Panda.
class GoalPoses : public ::testing::Test {
 protected:
  GoalPoses() {
    FreeSpaceMap map({.resolution = 0.02});
    for (double z = 0.01; z < 0.4; z += 0.02) occupy(map, {0.55, 0.0, z});
    save_map(map.snapshot(), folder_ / "map");
    std::filesystem::create_directory(folder_ / "scans");
    folder_.write("scans/100.pcd",
                  "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
                  "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n0.55 0 0.2\n");
  }
  CommandRun plan(const Arguments& more) {
    Arguments arguments{"plan",         "--map",           folder_.file("map"),
                        "--robot",      "panda",           "--policy",
                        "not_occupied", "--allow-outside", "all",
                        "--planner",    "rrtconnect",      "--start",
                        start,          "--out",           folder_.file("plan.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  Eigen::Isometry3d tip_at_goal() const {
    return tip_pose(robot_, load_plan(folder_.file("plan.json")).goals.back());
  }
  TemporaryFolder folder_;
  Robot robot_ = load_robot("panda");
};

TEST_F(GoalPoses, MayLeaveTheirTurnAboutAnAxisAndAToleranceOpen) {
  GoalPose down{Eigen::Isometry3d(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()))};
  down.map_from_tip.translation() = Eigen::Vector3d(0.4, 0.35, 0.3);
  const std::string pose = "--goal-pose=0.4,0.35,0.3,3.141592653589793,0,0";
  ASSERT_EQ(plan({pose}).status, exit_done);
  EXPECT_TRUE(reaches(down, tip_at_goal()));
  down.free_axis = 2;
  ASSERT_EQ(plan({pose, "--free-axis", "z"}).status, exit_done);
  EXPECT_TRUE(reaches(down, tip_at_goal()));
  const CommandRun checked =
      run_command({"check", folder_.file("plan.json"), "--map", folder_.file("map"), "--robot", "panda",
                   "--policy", "not_occupied", "--allow-outside", "all"});
  EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
  // Inside the post nothing is free; beside it, within the tolerance, it is.
  const std::string in_the_post = "--goal-pose=0.55,0,0.2,3.141592653589793,0,0";
  const CommandRun blocked = plan({in_the_post, "--free-axis", "z"});
  EXPECT_NE(blocked.status, exit_done);
  down.map_from_tip.translation() = Eigen::Vector3d(0.55, 0.0, 0.2);
  down.position_tolerance = 0.25;
  const CommandRun beside = plan({in_the_post, "--free-axis", "z", "--position-tolerance", "0.25"});
  ASSERT_EQ(beside.status, exit_done) << beside.out << beside.log;
  EXPECT_TRUE(reaches(down, tip_at_goal()));
}

TEST_F(GoalPoses, FlagsThatDoNotGoTogetherAreRefusedInOneSentence) {
  for (const Arguments& more :
       {Arguments{"--goal", start, "--free-axis", "z"},
        Arguments{"--goal", start, "--position-tolerance", "0.1"},
        Arguments{"--goal", start, "--turn-tolerance", "0.1"}, Arguments{"--goal", start, "--tip", "link5"},
        Arguments{"--goal", start, "--goal-pose=0.4,0,0.4"},
        Arguments{"--goal-pose=0.4,0,0.4", "--free-axis", "w"},
        Arguments{"--goal-pose=0.4,0,0.4", "--base=0,0,0,0,0,-90"},
        Arguments{"--goal-pose=0.4,0,0.4", "--turn-tolerance", "4"}}) {
    const CommandRun run = plan(more);
    EXPECT_EQ(run.status, exit_bad_input) << more[1];
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  }
}

TEST_F(GoalPoses, AnglesInDegreesAreRefusedAndWhoMayHaveMeantThemIsTold) {
  const CommandRun wide = plan({"--goal-pose=0.4,0.35,0.3,180,0,0"});
  EXPECT_EQ(wide.status, exit_bad_input);
  EXPECT_NE(wide.log.find("--goal-pose: expected angles in radians, each within a whole turn, got 180 (as "
                          "degrees: 3.14"),
            std::string::npos)
      << wide.log;
  const CommandRun small = plan({"--goal-pose=0.4,0.35,0.3,3.141592653589793,0,0", "--degrees"});
  EXPECT_NE(small.log.find("--degrees is of joint values"), std::string::npos) << small.log;
}

TEST_F(GoalPoses, OutOfReachAreAnInvalidGoalAndNoMistakeOfUsage) {
  const CommandRun far = plan({"--goal-pose=9,0,0", "--json", "--view", folder_.file("far.html")});
  EXPECT_EQ(far.status, exit_no) << far.log;
  const auto json = nlohmann::json::parse(far.out);
  EXPECT_EQ(json["status"], "goal_invalid");
  EXPECT_TRUE(json["explanation"].get<std::string>().starts_with(
      "The goal is out of reach: --goal-pose 9,0,0: no configuration of robot 'panda' within its limits "
      "was "))
      << json["explanation"];
  EXPECT_EQ(load_plan(folder_.file("plan.json")).status(), PlanStatus::goal_invalid);
  EXPECT_EQ(plan({"--goal-pose=9,0,0.4", "--position-tolerance", "0.1"}).status, exit_no);
  EXPECT_EQ(
      run_command({"check", folder_.file("plan.json"), "--map", folder_.file("map"), "--robot", "panda"})
          .status,
      exit_no);
}

TEST_F(GoalPoses, OfASetupsQueryAreTheSameForItsPlannersAndCheckedUnderItsRecord) {
  folder_.write("setup.yaml",
                "map: {resolution: 0.02}\nrobot: {name: panda}\nqueries:\n  - {name: past, start: "
                "[-0.8, 0.5, 0, -1.8, 0, 2.3, 0], goal_poses: [{pose_deg: [0.4, 0.35, 0.3, 180, 0, 0], "
                "free_axis: z}, {pose_deg: [0.4, -0.35, 0.3, 180, 0, 0]}], planners: [rrtconnect, auto], "
                "policies: {default: not_occupied}, allow_outside: [all]}\n");
  const CommandRun run = run_command(
      {"replay", folder_.file("scans"), "--setup", folder_.file("setup.yaml"), "--out", folder_.file("out")});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Plan one = load_plan(folder_.file("out/plans/past-rrtconnect.json"));
  EXPECT_EQ(one.goals, load_plan(folder_.file("out/plans/past-auto.json")).goals);
  ASSERT_EQ(one.goals.size(), 2U);
  GoalPose down{Eigen::Isometry3d(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()))};
  down.map_from_tip.translation() = Eigen::Vector3d(0.4, -0.35, 0.3);
  EXPECT_TRUE(reaches(down, tip_pose(robot_, one.goals[1])));
  const CommandRun checked = run_command({"check", folder_.file("out/plans/past-rrtconnect.json"), "--map",
                                          folder_.file("out"), "--robot", "panda"});
  EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
  folder_.write("setup.yaml",
                "map: {resolution: 0.02}\nrobot: {name: panda}\nqueries: [{name: past, start: "
                "[-0.8, 0.5, 0, -1.8, 0, 2.3, 0], goal_poses: [{pose: [9, 0, 0, 0, 0, 0]}]}]\n");
  const CommandRun far = run_command(
      {"replay", folder_.file("scans"), "--setup", folder_.file("setup.yaml"), "--out", folder_.file("far")});
  EXPECT_EQ(far.status, exit_bad_input);
  EXPECT_NE(far.log.find("query 'past', goal_poses[0]: no configuration"), std::string::npos) << far.log;
}

/// A post that the upper arm of a planar arm cannot pass: the nearer way of its elbow is behind it.
class PlanarGoalPoses : public ::testing::Test {
 protected:
  PlanarGoalPoses() {
    std::filesystem::create_directory(folder_ / "scans");
    folder_.write("scans/100.pcd",
                  "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
                  "HEIGHT 1\nVIEWPOINT 0 0 2 1 0 0 0\nPOINTS 1\nDATA ascii\n0.9 0 0\n");
    folder_.write(
        "setup.yaml",
        "map: {resolution: 0.02}\nrobot: {name: planar2}\nqueries:\n  - {name: across, start: [0.9, "
        "1.2], goal_poses: [{pose: [1.6, 0, 0, 0, 0, 0], free_axis: z}], planners: [rrtconnect], "
        "options: {rrtconnect.max_samples: 2000}, policies: {default: not_occupied}, "
        "allow_outside: [all]}\n");
    const CommandRun run = run_command({"replay", folder_.file("scans"), "--setup",
                                        folder_.file("setup.yaml"), "--out", folder_.file("out")});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  }

  CommandRun check(const Json& plan, const Arguments& more = {}) const {
    Arguments arguments{"check",   "--map",   folder_.file("out"),
                        "--robot", "planar2", folder_.write("edited.json", plan.dump())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  Json plan() const { return Json::parse(read_file(folder_.file("out/plans/across-rrtconnect.json"))); }

  TemporaryFolder folder_;
};

TEST_F(PlanarGoalPoses, OfASetupAreReachedByAnotherBranchThanTheNearestAndHeldToTheirPose) {
  const Json made = plan();
  ASSERT_EQ(made["status"], "solved") << made;
  const std::vector<double> end = made["waypoints"].back();
  EXPECT_NEAR(end[0], std::acos(0.8), 1e-4);  // the nearer one is (-0.64, 1.29)
  EXPECT_NEAR(end[1], -2.0 * std::acos(0.8), 1e-4);
  const CommandRun checked = check(made, {"--json"});
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  const Json contract = Json::parse(checked.out)["contract"];
  EXPECT_EQ(contract["query"], "across");
  EXPECT_EQ(contract["goals"]["source"], "map");
  EXPECT_EQ(contract["goal_poses"]["value"][0]["free_axis"], "z");
  // Both what the plan says and where its path ends, elsewhere: a millimetre is too far.
  Json edited = made;
  edited["waypoints"].back()[1] = edited["goals"][0][1] = end[1] + 1e-3;
  const CommandRun refused = check(edited);
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(
      refused.out.find("goal 1 of 1: expected the tip at (1.6, 0, 0, 0, 0, 0), turned freely about z by "
                       "the map's record, the path ends its leg 1 mm"),
      std::string::npos)
      << refused.out;
  edited.erase("motion");  // which leads to where the path ended
  EXPECT_EQ(check(edited, {"--accept-goals"}).status, exit_done) << check(edited, {"--accept-goals"}).out;
  Json none = made;
  none["legs"] = Json::array();
  none["waypoints"] = Json::array();
  EXPECT_NE(check(none).status, exit_done);
}

TEST_F(PlanarGoalPoses, OfTheChecksFlagsAreKeptAsTheArmsOwnGeometrySays) {
  const Json made = plan();
  const double q1 = made["waypoints"].back()[0], q2 = made["waypoints"].back()[1];
  const double x = std::cos(q1) + std::cos(q1 + q2), y = std::sin(q1) + std::sin(q1 + q2);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  int kept = 0;
  for (int i = 0; i < 40; ++i) {
    const double dx = 0.02 * part(random), dy = 0.02 * part(random), turn = 0.2 * part(random);
    const double metres = 0.04 * std::abs(part(random)), radians = 0.4 * std::abs(part(random));
    const bool is_free = i % 3 == 0;
    const auto number = [](double value) { return std::to_string(value); };
    Arguments flags{
        "--goal-pose=" + number(x + dx) + "," + number(y + dy) + ",0,0,0," + number(q1 + q2 + turn),
        "--position-tolerance", number(metres), "--turn-tolerance", number(radians)};
    if (is_free) flags.insert(flags.end(), {"--free-axis", "z"});
    const bool is_kept = std::hypot(dx, dy) <= metres && (is_free || std::abs(turn) <= radians);
    const CommandRun run = check(made, flags);
    EXPECT_EQ(run.status, is_kept ? exit_done : exit_no) << flags[0] << run.out << run.log;
    kept += is_kept;
  }
  EXPECT_GT(kept, 5);
  EXPECT_LT(kept, 35);
  // A link in place of the tip; two poses for one leg; goals of both kinds; a link that is none.
  const std::string elbow = "--goal-pose=" + std::to_string(std::cos(q1)) + "," +
                            std::to_string(std::sin(q1)) + ",0,0,0," + std::to_string(q1 + q2);
  EXPECT_EQ(check(made, {elbow, "--tip", "forearm"}).status, exit_done);
  EXPECT_EQ(check(made, {elbow}).status, exit_no);
  const CommandRun two = check(made, {elbow, elbow, "--tip", "forearm"});
  EXPECT_EQ(two.status, exit_no);
  EXPECT_NE(two.out.find("goal 2 of 2: is not reached"), std::string::npos) << two.out;
  for (const Arguments& flags : {Arguments{elbow, "--goal", "0,0"}, Arguments{elbow, "--tip", "hand"},
                                 Arguments{"--tip", "forearm"}}) {
    const CommandRun run = check(made, flags);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  }
}

}  // namespace goal_pose_test
}  // namespace clearway
