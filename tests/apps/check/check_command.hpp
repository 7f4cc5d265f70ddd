#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace check_test {

using Json = nlohmann::json;

/// A painted sphere about the origin, which the point robot's disc fits into, and a plan inside it.
class Check : public ::testing::Test {
 protected:
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.05});
    map.paint(map.add_volume("free", {"base"}), {Eigen::Vector3d::Zero(), 1.0});
    save_map(map.snapshot(), folder_.path() / "map");
    const CommandRun plan = run_command({"plan", "--map", folder_.file("map"), "--robot", "point",
                                         "--start=-0.3,0", "--goal=0.3,0", "--goal=0.3,0.2", "--planner",
                                         "rrtconnect", "--out", folder_.file("plan.json")});
    ASSERT_EQ(plan.status, exit_done) << plan.out << plan.log;
    plan_ = Json::parse(read_file(folder_.file("plan.json")));
  }

  CommandRun check(const Json& plan, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"check",   "--map", folder_.file("map"),
                                       "--robot", "point", folder_.write("edited.json", plan.dump())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  /// The plan with its last waypoint, and its goal, outside the painted sphere.
  Json leaving() const {
    Json plan = plan_;
    plan["waypoints"].back() = plan["goals"].back() = {0.3, 1.5};
    return plan;
  }

  TemporaryFolder folder_;
  Json plan_;
};

/// The terms of the refusals, as the flags that accept them are called.
inline std::vector<std::string> refused_terms(const CommandRun& run) {
  const Json json = Json::parse(run.out);
  std::vector<std::string> terms;
  for (const Json& deviation : json["deviations"]) {
    if (!deviation["accepted"].get<bool>()) terms.push_back(deviation["term"]);
  }
  return terms;
}

using Terms = std::vector<std::string>;

}  // namespace check_test
}  // namespace clearway
