#include "apps/suites/suite_resolutions.hpp"

#include <gtest/gtest.h>

#include "apps/suites/suite_stages.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace suite_resolutions_test {

const std::string listed = R"(
planners: [{planner: beam}]
worlds:
  - name: painted
    resolution: 0.05
    volumes: [{label: free, strokes: [{balls: [[0.5, 0, 0.5, 0.3]]}]}]
  - {name: loaded, map: hall.bt}
experiments:
  - name: reach
    robot: puma560
    world: WORLD
    resolutions: LIST
    problems:
      - {name: a, start: [0, 0, 0, 0, 0, 0], goals: [[1, 0, 0, 0, 0, 0]]}
      - {name: b, start: [0, 0, 0, 0, 0, 1], goals: [[1, 0, 0, 0, 0, 0]], world: painted}
  - {name: NAME, robot: puma560, generate: {kind: tunnels, count: 2, seed: 4, resolution: 0.05}}
  - {name: coarse, robot: puma560, generate: {kind: tunnels, count: 2, seed: 4, resolution: 0.1}}
  - {name: longer, robot: puma560, generate: {kind: tunnels, count: 3, seed: 4, resolution: 0.2}}
  - {name: other_arm, robot: panda, generate: {kind: tunnels, count: 2, seed: 4, resolution: 0.2}}
)";

std::string with(const std::string& world, const std::string& list, const std::string& name = "fine") {
  std::string text = listed;
  for (const auto& [from, to] : {std::pair("WORLD", world), std::pair("LIST", list), std::pair("NAME", name)})
    text.replace(text.find(from), std::string(from).size(), to);
  return text;
}

Suite expanded(const std::string& text) {
  Suite suite = parse_suite(text, "s.yaml");
  expand_resolutions(suite);
  return suite;
}

std::string refusal(const std::string& text) {
  try {
    expanded(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(SuiteResolutions, EachIsAnExperimentInItsOwnWorld) {
  const Suite suite = expanded(with("painted", "[0.1, 0.025]"));
  ASSERT_EQ(suite.experiments.size(), 6U);
  const Robot robot = load_robot("puma560");
  const double resolutions[] = {0.1, 0.025};
  for (std::size_t i = 0; i < 2; ++i) {
    const SuiteExperiment& experiment = suite.experiments[i];
    EXPECT_EQ(experiment.name, i == 0 ? "reach-0.1" : "reach-0.025");
    EXPECT_EQ(experiment.alike, "reach-0.1");
    const SuiteStages stages(suite, experiment, robot);
    ASSERT_EQ(stages.size(), 1U) << "the problem that names the world lies in the same one";
    EXPECT_EQ(stages.make(0).map.resolution(), resolutions[i]);
    EXPECT_EQ(stages.make(0).problems.size(), 2U);
  }
  EXPECT_EQ(suite.worlds.front().resolution, 0.05) << "the suite's own stays for others";
}

TEST(SuiteResolutions, GeneratedExperimentsThatDifferInNothingElseAreAlike) {
  const Suite suite = expanded(with("painted", "[0.1, 0.025]"));
  EXPECT_EQ(suite.experiments[2].alike, "fine");
  EXPECT_EQ(suite.experiments[3].alike, "fine");
  EXPECT_EQ(suite.experiments[4].alike, "") << "other problems";
  EXPECT_EQ(suite.experiments[5].alike, "") << "another robot";
}

TEST(SuiteResolutions, ThoseOfAGeneratorReplaceItsResolution) {
  std::string text = with("painted", "[0.1, 0.025]");
  const std::string before = "generate: {kind: tunnels, count: 3, seed: 4, resolution: 0.2}";
  text.replace(text.find(before), before.size(),
               "resolutions: [0.03, 0.06], generate: {kind: tunnels, count: 3, seed: 4}");
  const Suite suite = expanded(text);
  ASSERT_EQ(suite.experiments.size(), 7U);
  EXPECT_EQ(suite.experiments[4].generate->resolution, 0.03);
  EXPECT_EQ(suite.experiments[5].name, "longer-0.06");
  EXPECT_EQ(suite.experiments[5].generate->resolution, 0.06);
}

TEST(SuiteResolutions, NonsenseIsRefusedInASentence) {
  EXPECT_NE(refusal(with("painted", "[0.1]")).find(".resolutions: expected 2 to 20 resolutions, got 1"),
            std::string::npos)
      << refusal(with("painted", "[0.1]"));
  EXPECT_NE(refusal(with("painted", "[0.1, 0.1]")).find("expected each resolution once"), std::string::npos);
  EXPECT_NE(refusal(with("painted", "[0.1, -1]")).find("resolutions"), std::string::npos);
  EXPECT_NE(refusal(with("painted", "[0.1, 1e-9]")).find("resolutions"), std::string::npos);
  EXPECT_NE(refusal(with("painted", "fine")).find("resolutions"), std::string::npos);
  EXPECT_NE(refusal(with("painted", "[0.1, 1e-4]")).find("coarser"), std::string::npos)
      << "more voxels than a world may have";
  EXPECT_NE(refusal(with("loaded", "[0.1, 0.2]")).find("map of world 'loaded' is loaded"), std::string::npos);
  EXPECT_NE(refusal(with("painted", "[0.1, 0.2]", "reach-0.1"))
                .find("'resolutions': makes a second experiment 'reach-0.1'"),
            std::string::npos);
  std::string both = with("painted", "[0.1, 0.2]");
  both.replace(both.find("robot: panda,"), 13, "robot: panda, resolutions: [0.1, 0.2],");
  EXPECT_NE(refusal(both).find("expected nothing beside the 'resolution' of 'generate'"), std::string::npos);
}

}  // namespace suite_resolutions_test
}  // namespace clearway
