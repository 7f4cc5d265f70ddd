#include "datasets/descriptions/suite_limits.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace suite_limits_test {

std::string complaint_of(const std::string& world, const std::string& more = "") {
  return complaint([&] {
    parse_suite("worlds: [{name: w, " + world +
                    "}]\nplanners: [{planner: beam}]\nexperiments:\n- {name: e, " +
                    "robot: arm5, world: w, problems: [{name: p, start: [0], goals: [[1]]}]" + more + "}\n",
                "s.yaml");
  });
}

TEST(SuiteLimits, a_box_of_65_km_is_refused_with_its_field_its_figure_and_the_limit) {
  const std::string sentence =
      complaint_of("resolution: 0.02, sensors: [[0, 0, 1]], solids: [{name: s, box: [65000, 65000, 65000]}]");
  EXPECT_NE(sentence.find("suite 's.yaml', line 1, worlds[0].solids[0].box: expected"), std::string::npos)
      << sentence;
  EXPECT_NE(sentence.find("at most 2.5e+07 points half a voxel (0.01 m) apart on them, got 2.535e+14"),
            std::string::npos)
      << sentence;
}

TEST(SuiteLimits, every_extent_that_asks_for_more_than_a_gigabyte_is_refused) {
  const std::string sensors = "resolution: 0.001, sensors: [[0, 0, 1]]";
  for (const auto& [world, field] : std::vector<std::pair<std::string, std::string>>{
           {sensors + ", solids: [{name: s, sphere: 3}]", "solids[0].sphere"},
           {sensors + ", solids: [{name: s, cylinder: [1, 3]}]", "solids[0].cylinder"},
           {sensors + ", sensor_range: 5", "sensor_range"},
           {"resolution: 0.001, volumes: [{label: v, strokes: [{balls: [[0, 0, 0, 2]]}]}]",
            "volumes[0].strokes"}})
    EXPECT_NE(complaint_of(world).find(field + ": expected"), std::string::npos) << complaint_of(world);
  const std::string runs = complaint([] {
    parse_suite(
        "experiments: [{name: e, robot: arm5, generate: {kind: boxes, count: 100000}, runs: 100, "
        "planners: [{planner: beam}]}]\n",
        "s.yaml");
  });
  EXPECT_NE(runs.find("experiments[0].runs: expected at most 1e+06 runs"), std::string::npos) << runs;
  EXPECT_NE(runs.find("got 1e+07"), std::string::npos) << runs;
}

TEST(SuiteLimits, an_exact_world_of_too_many_voxels_is_refused) {
  EXPECT_EQ(complaint_of("resolution: 0.01, exact: true, solids: [{name: s, box: [2, 2, 2]}]"), "");
  for (const std::string solid : {"box: [3, 3, 3]", "sphere: 1.5", "cylinder: [1.5, 3]"}) {
    const std::string sentence =
        complaint_of("resolution: 0.01, exact: true, solids: [{name: s, " + solid + "}]");
    EXPECT_NE(sentence.find("worlds[0].solids: expected at most 2.5e+07 voxels of 0.01 m"), std::string::npos)
        << solid << sentence;
    EXPECT_NE(sentence.find("up to 's'"), std::string::npos) << sentence;
  }
}

TEST(SuiteLimits, what_the_suites_of_the_papers_ask_for_is_far_below) {
  EXPECT_EQ(complaint_of("resolution: 0.02, sensors: [[0, 0, 1]], sensor_range: 5, "
                         "solids: [{name: s, box: [10, 10, 0.1]}]"),
            "");
}

}  // namespace suite_limits_test
}  // namespace clearway
