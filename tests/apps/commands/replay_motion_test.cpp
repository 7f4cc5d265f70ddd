// What `replay` gives plans to move by: the smooth motion, or a sentence why there is none.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "planning/files/plan_file.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace replay_motion_test {

using Json = nlohmann::json;

/// A scan of a post at (1, 0), and a Panda that goes past it by hand from the left to the right.
class ReplayMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ostringstream points;
    int count = 0;
    for (double z = 0.0; z < 0.4; z += 0.02)
      for (double y = -0.05; y <= 0.05; y += 0.02, ++count) points << "0.55 " << y << ' ' << z << '\n';
    const std::string size = std::to_string(count);
    std::filesystem::create_directory(folder_.path() / "scans");
    folder_.write("scans/100.pcd",
                  "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                      size + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + size + "\nDATA ascii\n" +
                      points.str());
  }

  /// @param robot more of the setup's robot: ", payload: 2"
  static std::string setup_of(const std::string& robot) {
    return "map: {resolution: 0.02}\nrobot: {name: panda" + robot +
           "}\nqueries:\n  - {name: past, start: [-0.8, 0.5, 0, -1.8, 0, 2.3, 0], goals: [[0.8, 0.5, 0, "
           "-1.8, 0, 2.3, 0]], planners: [rrtconnect], policies: {default: not_occupied}, "
           "allow_outside: [all]}\n";
  }
  CommandRun replay(const std::string& out, const std::string& robot = "") {
    return replay_setup(out, setup_of(robot));
  }
  CommandRun replay_setup(const std::string& out, const std::string& setup) {
    folder_.write("setup.yaml", setup);
    return run_command(
        {"replay", folder_.file("scans"), "--setup", folder_.file("setup.yaml"), "--out", folder_.file(out)});
  }
  std::string plan_file(const std::string& out) const {
    return folder_.file(out + "/plans/past-rrtconnect.json");
  }
  Json report(const std::string& out) const {
    return Json::parse(read_file(folder_.file(out + "/report.json")))["plans"][0];
  }

  TemporaryFolder folder_;
};

TEST_F(ReplayMotion, IsSmoothInPlanAndReportAndCheckedUnderTheRecordsPayload) {
  const CommandRun run = replay("one", ", payload: 1.5");
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Plan plan = load_plan(plan_file("one"));
  ASSERT_TRUE(plan.motion);
  EXPECT_GT(plan.waypoints().size(), 2U);
  EXPECT_LT(plan.motion->motion.duration(),
            time_parameterize(load_robot("panda"), plan.waypoints()).points.back().time);
  EXPECT_EQ(report("one")["motion"]["duration_s"], plan.motion->motion.duration());
  EXPECT_EQ(report("one")["motion"]["smooth"], true);
  const CommandRun checked =
      run_command({"check", plan_file("one"), "--map", folder_.file("one"), "--robot", "panda", "--json"});
  ASSERT_EQ(checked.status, exit_done) << checked.out << checked.log;
  const Json verdict = Json::parse(checked.out);
  EXPECT_EQ(verdict["motion"]["verdict"], "valid");
  EXPECT_GT(verdict["motion"]["torque_share"], 0.0);
  EXPECT_EQ(verdict["contract"]["payload_kg"], Json({{"value", 1.5}, {"source", "map"}}));
}

TEST_F(ReplayMotion, AQueryInDegreesIsToldTheKeyForThem) {
  std::string setup = setup_of("");
  const std::string start = "start: [-0.8, 0.5, 0, -1.8, 0, 2.3, 0]";
  setup.replace(setup.find(start), start.size(), "start: [-45.8, 28.6, 0, -103.1, 0, 131.8, 0]");
  const CommandRun run = replay_setup("one", setup);
  EXPECT_NE(run.log.find("note: setup, query 'past', field 'start' is far outside of the joint limits in "
                         "radians and within them in degrees: 'start_deg' reads it so"),
            std::string::npos)
      << run.log;
  EXPECT_EQ(replay("two").log.find("_deg"), std::string::npos);
}

TEST_F(ReplayMotion, IsTheSameByteForByteWhenDoneAgain) {
  ASSERT_EQ(replay("one").status, exit_done);
  ASSERT_EQ(replay("two").status, exit_done);
  const auto without_time = [&](const std::string& out) {
    return std::regex_replace(read_file(plan_file(out)), std::regex("\"time_s\": [^\n]*"), "");
  };
  ASSERT_NE(without_time("one").find("\"motion\""), std::string::npos);
  EXPECT_EQ(without_time("one"), without_time("two"));
}

TEST_F(ReplayMotion, ThatTorquesForbidIsShownInReportAndPage) {
  const CommandRun run = replay("heavy", ", payload: 200");
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_FALSE(load_plan(plan_file("heavy")).motion);
  const Json motion = report("heavy")["motion"];
  EXPECT_EQ(motion["smooth"], false);
  EXPECT_NE(motion["note"].get<std::string>().find("the torque of joint"), std::string::npos) << motion;
  EXPECT_NE(run.out.find("past, rrtconnect: no smooth motion: the check refuses it"), std::string::npos)
      << run.out;
  const std::string page = read_file(folder_.file("heavy/report.html"));
  EXPECT_NE(page.find("none: the check refuses it"), std::string::npos);
}

}  // namespace replay_motion_test
}  // namespace clearway
