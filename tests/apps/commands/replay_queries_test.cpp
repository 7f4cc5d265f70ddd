#include "apps/commands/replay_queries.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/apps/run_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace replay_queries_test {

using Json = nlohmann::json;

/// A scan of one point far away, and an arm of two joints with a gripper whose SRDF lies elsewhere.
class ReplayQueries : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* folder : {"scans", "semantic"}) std::filesystem::create_directory(folder_ / folder);
    folder_.write("scans/100.pcd",
                  "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
                  "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n3 3 3\n");
    folder_.write("arm.urdf", worlds::arm_with_finger());
    folder_.write(
        "semantic/arm.srdf",
        "<robot name='arm'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
        "<group_state name='home' group='arm'><joint name='shoulder' value='0'/>"
        "<joint name='elbow' value='0.1'/></group_state>"
        "<group_state name='ready' group='arm'><joint name='shoulder' value='0.5'/>"
        "<joint name='elbow' value='-0.1'/></group_state>"
        "<group_state name='half' group='arm'><joint name='elbow' value='-0.2'/></group_state></robot>");
  }

  /// @param ways of the query: "start: home, goals: [ready]"
  CommandRun replay(const std::string& ways, const std::string& terms = ", group: arm, fixed: {grip: 0.03}") {
    std::filesystem::remove_all(folder_ / "out");
    folder_.write("setup.yaml", "map: {resolution: 0.05}\nrobot: {name: arm.urdf, srdf: semantic/arm.srdf" +
                                    terms + "}\nqueries:\n  - {name: q, " + ways +
                                    ", planners: [rrtconnect], policies: {default: not_occupied}, "
                                    "allow_outside: [all]}\n");
    return run_command({"replay", folder_.file("scans"), "--setup", folder_.file("setup.yaml"), "--out",
                        folder_.file("out")});
  }

  Json plan() const { return Json::parse(read_file(folder_ / "out/plans/q-rrtconnect.json")); }

  TemporaryFolder folder_;
};

TEST_F(ReplayQueries, PlanTheGroupOfTheSetupBetweenStatesAsFlagsDo) {
  const CommandRun run = replay("start: home, goals: [ready, [0.2, 0.3], half]");
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(plan()["joints"], (Json{"shoulder", "elbow"}));
  EXPECT_EQ(plan()["group"], "arm");
  EXPECT_EQ(plan()["held"], (Json{{"grip", 0.03}}));
  EXPECT_EQ(plan()["start"], (Json{0.0, 0.1}));
  EXPECT_EQ(plan()["goals"], (Json{{0.5, -0.1}, {0.2, 0.3}, {0.2, -0.2}}));
  EXPECT_NE(
      run.log.find("note: setup, query 'q', field 'goals[2]': state 'half' does not name joint shoulder "
                   "(0.2), which stays where the stop before has it"),
      std::string::npos)
      << run.log;
  const CommandRun checked =
      run_command({"check", "--map", folder_.file("out"), "--robot", folder_.file("arm.urdf"), "--srdf",
                   folder_.file("semantic/arm.srdf"), "--group", "arm", "--fix", "grip=0.03",
                   folder_.file("out/plans/q-rrtconnect.json")});
  EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
}

TEST_F(ReplayQueries, NameTheFieldOfAStateThatTheRobotDoesNotHave) {
  const auto refused = [&](const CommandRun& run, const std::string& words) {
    EXPECT_EQ(run.status, exit_bad_input) << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
  };
  refused(replay("start: hme, goals: [ready]"),
          "setup, query 'q', field 'start': robot 'arm' has no state 'hme', did you mean 'home'?");
  refused(replay("start: home, goals: [[0, 0], reddy]"),
          "setup, query 'q', field 'goals[1]': robot 'arm' has no state 'reddy', did you mean 'ready'?");
  refused(replay("start: home, goals: [ready]", ", group: amr"),
          "there is no group 'amr', expected one of arm");
  refused(replay("start: home, goals: [ready]", ", group: arm, fixed: {gripp: 0.03}"),
          "setup, robot, fixed: joint 'gripp' cannot be fixed");
  refused(replay("start: [0, 0, 0], goals: [ready]"), "field 'start': got 3 values, expected 2");
}

}  // namespace replay_queries_test
}  // namespace clearway
