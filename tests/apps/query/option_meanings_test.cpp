#include "apps/query/option_meanings.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "planning/planner_table.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace option_meanings_test {

TEST(OptionMeanings, EveryOptionOfEveryPlannerHasOne) {
  for (const PlannerEntry& entry : planner_table()) {
    const auto planner = make_planner(entry.name);
    for (const auto& [option, value] : planner->options())
      EXPECT_GT(option_meaning(std::string(entry.name), option).size(), 5U) << entry.name << " " << option;
  }
  EXPECT_EQ(option_meaning("beam", "no_such_option"), "");
  EXPECT_EQ(option_meaning("external", "width"), "");
}

TEST(OptionMeanings, StandBesideTheFieldInTheHeader) {
  const std::string header = read_file(CLEARWAY_SOURCE_DIR "/planning/beam/beam_options.hpp");
  const std::string meaning = option_meaning("beam", "width");
  EXPECT_LT(header.find("int width"), header.find(meaning));
  EXPECT_EQ(header.find('\n', header.find("int width")), header.find(meaning) + meaning.size());
  EXPECT_TRUE(option_meaning("beam", "step").ends_with("auto: the robot's own"))
      << "its comment has two lines";
  EXPECT_EQ(option_meaning("boundary", "xi"), option_meaning("constraint", "xi")) << "of a struct inside";
}

TEST(OptionMeanings, ArePrintedAsCommentsBesideTheOptions) {
  const CommandRun run = run_command({"plan", "--planner", "beam", "--set", "width=7", "--print-options"});
  EXPECT_EQ(run.status, 0) << run.log;
  const std::size_t at = run.out.find("width: 7 ");
  ASSERT_NE(at, std::string::npos) << run.out;
  EXPECT_NE(run.out.find("# " + option_meaning("beam", "width") + "\n", at), std::string::npos) << run.out;
}

}  // namespace option_meanings_test
}  // namespace clearway
