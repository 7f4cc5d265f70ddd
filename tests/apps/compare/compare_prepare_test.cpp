#include <gtest/gtest.h>

#include "apps/compare/compare_run.hpp"

namespace clearway {
namespace compare_prepare_test {

Suite suite_with(const std::string& more) {
  return parse_suite(
      "worlds: [{name: w, resolution: 0.1, volumes: [{label: v, strokes: [{balls: [[0, 0, 0, 0.3]]}]}]}]\n"
      "planners: [{planner: beam}]\nexperiments:\n  - {name: e, robot: planar2, world: w" +
          more + ", problems: [{name: p, start: [0, 0], goals: [[1, 0]]}]}\n",
      "s.yaml");
}

Robot robot_with(const std::string& more) {
  const Suite suite = suite_with(more);
  return prepare(suite, suite.experiments.at(0), {}).robot;
}

TEST(ComparePrepare, TheRobotStandsWhereTheExperimentSays) {
  const Eigen::Isometry3d own = robot_with("").map_from_base;
  const Robot moved = robot_with(", base_deg: [1, 2, 0.5, 0, 0, 90], scale: 0.5");
  EXPECT_TRUE(own.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(moved.scale, 0.5);
  EXPECT_EQ(moved.map_from_base.translation(), Eigen::Vector3d(1, 2, 0.5));
  EXPECT_TRUE((moved.map_from_base.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

}  // namespace compare_prepare_test
}  // namespace clearway
