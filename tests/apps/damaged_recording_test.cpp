// A map from a damaged recording says so wherever it is used.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace damaged_recording_test {

constexpr const char* scan =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1.05 0.05 0.05\n1.05 0.15 0.05\n";

TEST(DamagedRecording, IsReportedByInspectPlanAndCheck) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scans");
  folder.write("scans/1.pcd", scan);
  folder.write("scans/2.pcd", std::string(scan).substr(0, 60));
  const std::string map = folder.file("map"), plan = folder.file("plan.json");
  ASSERT_EQ(run_command({"replay", folder.file("scans"), "--out", map, "--quiet"}).status, exit_damaged);
  const std::string words = "made from a damaged recording: 1 record";

  EXPECT_NE(run_command({"inspect", map}).out.find(words), std::string::npos);
  const auto json = nlohmann::json::parse(run_command({"inspect", map, "--json"}).out);
  EXPECT_NE(json["damaged_recording"].get<std::string>().find(words), std::string::npos);
  EXPECT_NE(run_command({"plan", "--map", map, "--robot", "point", "--start=-1,0", "--goal=-1,0.5",
                         "--policy", "not_occupied", "--planner", "rrtconnect", "--out", plan})
                .log.find(words),
            std::string::npos);
  EXPECT_NE(run_command({"check", plan, "--map", map, "--robot", "point"}).log.find(words),
            std::string::npos);
  const auto saved = nlohmann::json::parse(read_file(plan));
  EXPECT_NE(saved["validation"]["map_caveat"].get<std::string>().find(words), std::string::npos);
  const auto checked =
      nlohmann::json::parse(run_command({"check", plan, "--map", map, "--robot", "point", "--json"}).out);
  EXPECT_NE(checked["map_caveat"].get<std::string>().find(words), std::string::npos);
}

TEST(DamagedRecording, IsOneWithAScanThatIsALinkToNothing) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scans");
  folder.write("scans/1.pcd", scan);
  std::filesystem::create_symlink("gone.pcd", folder.path() / "scans/2.pcd");
  const CommandRun run = run_command({"replay", folder.file("scans"), "--out", folder.file("map")});
  EXPECT_EQ(run.status, exit_damaged);
  EXPECT_NE(run.log.find("2.pcd' cannot be read: No such file"), std::string::npos) << run.log;
  EXPECT_NE(run_command({"inspect", folder.file("map")}).out.find("made from a damaged recording"),
            std::string::npos);
}

}  // namespace damaged_recording_test
}  // namespace clearway
