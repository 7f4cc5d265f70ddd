// Goals that are poses, from the flags of `plan` and from a setup's queries.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
        Arguments{"--goal-pose=0.4,0,0.4", "--turn-tolerance", "4"},
        Arguments{"--goal-pose=9,0,0.4", "--position-tolerance", "0.1"}}) {
    const CommandRun run = plan(more);
    EXPECT_EQ(run.status, exit_bad_input) << more[1];
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  }
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

}  // namespace goal_pose_test
}  // namespace clearway
