// What the newest scan hit is blocked, and what left is free again: through the command line, from a folder
// of clouds with viewpoints to a plan's exit status.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace newest_scan_test {

using Json = nlohmann::json;

/// A cloud seen from the origin: a wall 2 m ahead, and before it a box 1 m ahead when there is one.
std::string cloud(bool box) {
  std::ostringstream points;
  int count = 0;
  for (double y = -1.6; y < 1.6; y += 0.025) {
    for (double z = -0.6; z < 0.6; z += 0.025) {
      const bool meets = box && std::abs(y) < 1.4 && std::abs(z) < 0.4;
      points << (meets ? 1.0 : 2.0) << ' ' << (meets ? 0.5 * y : y) << ' ' << (meets ? 0.5 * z : z) << '\n';
      ++count;
    }
  }
  const std::string number = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + number +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA ascii\n" + points.str();
}

class NewestScan : public ::testing::Test {
 protected:
  void scan(int times, bool box) {
    std::filesystem::create_directory(folder_.path() / "scans");
    for (int i = 0; i < times; ++i) folder_.write("scans/" + std::to_string(++scans_) + ".pcd", cloud(box));
  }
  Json replay(const std::string& integration = "safe") {
    const CommandRun run = run_command({"replay", folder_.file("scans"), "--out", folder_.file("map"),
                                        "--resolution", "0.05", "--no-plan", "--integration", integration});
    EXPECT_EQ(run.status, exit_done) << run.log;
    printed_ = run.out;
    return Json::parse(run_command({"inspect", folder_.file("map"), "--at", "1.01,0.01,0.01", "--json"}).out);
  }
  CommandRun plan() const {
    return run_command({"plan", "--map", folder_.file("map"), "--robot", "point", "--policy", "known_free",
                        "--start=0.65,0", "--goal=1.5,0", "--planner", "boundary", "--out",
                        folder_.file("plan.json"), "--time-limit", "5"});
  }

  TemporaryFolder folder_;
  int scans_ = 100;      // names that are numbers are times
  std::string printed_;  // by the last replay
};

TEST_F(NewestScan, a_box_that_came_into_free_space_is_not_planned_through_and_free_again_soon_after_it_left) {
  scan(20, false);
  EXPECT_EQ(replay()["at"][0]["state"], "seen_free");
  EXPECT_EQ(plan().status, exit_done);
  scan(1, true);
  const Json one = replay();
  EXPECT_EQ(one["at"][0]["state"], "occupied");
  EXPECT_EQ(one["integration"], "safe");
  EXPECT_EQ(plan().status, exit_no);
  scan(1, true);
  EXPECT_EQ(replay()["at"][0]["state"], "occupied");
  EXPECT_EQ(plan().status, exit_no);
  scan(20, true);
  replay();
  scan(5, false);
  EXPECT_EQ(replay()["at"][0]["state"], "seen_free");
  EXPECT_EQ(plan().status, exit_done);
}

TEST_F(NewestScan, a_map_of_compatible_integration_is_named_as_such) {
  scan(2, false);
  EXPECT_EQ(replay("compatible")["integration"], "compatible");
  EXPECT_NE(run_command({"inspect", folder_.file("map")}).out.find("compatible"), std::string::npos);
  EXPECT_NE(printed_.find("made by compatible integration"), std::string::npos) << printed_;
  const CommandRun run = plan();
  EXPECT_EQ(run.status, exit_done);
  EXPECT_NE(run.out.find("compatible integration"), std::string::npos) << run.out;
  const CommandRun check =
      run_command({"check", folder_.file("plan.json"), "--map", folder_.file("map"), "--robot", "point",
                   "--policy", "known_free", "--start=0.65,0", "--goal=1.5,0"});
  EXPECT_NE(check.out.find("compatible integration"), std::string::npos) << check.out;
}

}  // namespace newest_scan_test
}  // namespace clearway
