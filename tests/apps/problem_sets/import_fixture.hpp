#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapping/files/map_file.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway::import_test {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

inline const std::string arm_request =
    "start_state:\n"
    "  joint_state:\n"
    "    name: [grip, elbow, shoulder]\n"
    "    position: [0.02, 0.1, 0.0]\n"
    "group_name: arm\n"
    "goal_constraints:\n"
    "  - joint_constraints:\n"
    "      - {joint_name: shoulder, position: 0.5, tolerance_above: 0.01, weight: 1}\n"
    "      - {joint_name: left_elbow, position: -0.1}\n";  // a prefix that the robot lacks

class Import : public ::testing::Test {
 protected:
  void SetUp() override { robot_ = folder_.write("arm.urdf", worlds::arm_with_finger()); }

  CommandRun import(const std::string& kind, const Arguments& files, const Arguments& more = {}) const {
    Arguments arguments{"import", "--out",        folder_.file("out"), "--robot",
                        robot_,   "--resolution", resolution_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.push_back(kind);
    arguments.insert(arguments.end(), files.begin(), files.end());
    return run_command(arguments);
  }

  Snapshot map(const std::string& name) const { return load_map(folder_.path() / "out/maps" / name); }

  TemporaryFolder folder_;
  std::string robot_, resolution_ = "0.1";
};

/// `compare` of what was imported: its first planner's row.
inline Json compared(const TemporaryFolder& folder) {
  const CommandRun run =
      run_command({"compare", folder.file("out/suite.yaml"), "--out", folder.file("results"), "--json"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  return Json::parse(run.out)["experiments"][0]["planners"][0];
}

}  // namespace clearway::import_test
