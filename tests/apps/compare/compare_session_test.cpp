#include "apps/compare/compare_session.hpp"

#include <gtest/gtest.h>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace compare_session_test {

/// No configuration is free in the first experiment's map, which has no paint.
const std::string nothing_painted = R"(
time_limit: 5
planners: [{planner: beam}]
worlds: [{name: empty, resolution: 0.1, volumes: [{label: v, strokes: [{balls: [[0, 0, 0, 0.3]]}]}]}]
experiments:
  - name: in vain
    robot: arm5
    generate: {kind: boxes, count: 12, seed: 1, resolution: 0.1}
    policies: {default: painted}
)";
const std::string another = R"(  - name: swing
    robot: planar2
    world: empty
    problems: [{name: swing, start: [0, 0], goals: [[1, 0.5]]}]
    policies: {default: not_occupied}
)";

class CompareInVain : public testing::Test {
 protected:
  CommandRun compare(const std::string& suite, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {
        "compare", folder_.write("s.yaml", suite), "--out", folder_.file("out"), "--worst-pages", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }

  TemporaryFolder folder_;
};

TEST_F(CompareInVain, AnExperimentInWhichNoProblemIsFoundDoesNotEndTheOthers) {
  const CommandRun run = compare(nothing_painted + another);
  EXPECT_EQ(run.status, 0) << run.log;
  EXPECT_NE(run.out.find("== swing"), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("== in vain"), std::string::npos) << run.out;
  for (const char* scene : {"'boxes 1'", "'boxes 2'"})
    EXPECT_NE(run.log.find("note: experiment 'in vain' is without one of its worlds: boxes: no problem found "
                           "for robot 'arm5' under all parts painted in " +
                           std::string(scene)),
              std::string::npos)
        << run.log;
  EXPECT_NE(read_file(folder_.file("out/report.html")).find("without one of its worlds"), std::string::npos);
  const CommandRun again = compare(nothing_painted + another, {"--resume"});
  EXPECT_EQ(again.status, 0) << again.log;
  EXPECT_NE(again.log.find("nothing was left to run"), std::string::npos) << again.log;
  EXPECT_NE(again.log.find("without one of its worlds"), std::string::npos) << again.log;
}

TEST_F(CompareInVain, PartsOfSuchAComparisonMerge) {
  for (const char* part : {"1", "2"})
    ASSERT_EQ(run_command({"compare", folder_.write("s.yaml", nothing_painted + another), "--out",
                           folder_.file(part), "--shard", std::string(part) + "/2", "--quiet"})
                  .status,
              0);
  const CommandRun whole =
      run_command({"compare", "merge", folder_.file("1"), folder_.file("2"), "--out", folder_.file("all")});
  EXPECT_EQ(whole.status, 0) << whole.log;
  EXPECT_NE(whole.log.find("'in vain' is without one of its worlds"), std::string::npos) << whole.log;
}

TEST_F(CompareInVain, WhereThereIsNoProblemAtAllItIsRefused) {
  const CommandRun run = compare(nothing_painted);
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.log.find("clearway: boxes: no problem found for robot 'arm5'"), std::string::npos) << run.log;
  const CommandRun one =
      run_command({"compare", folder_.file("s.yaml"), "--rerun", "in_vain/boxes_1.1/beam"});
  EXPECT_EQ(one.status, 2);
  EXPECT_EQ(one.log, run.log);
}

TEST_F(CompareInVain, MergingSaysWhatTheWholeRunSaysWhereThereIsNoProblemAtAll) {
  const CommandRun whole = compare(nothing_painted, {"--quiet"});
  for (const char* part : {"1", "2"})
    ASSERT_EQ(run_command({"compare", folder_.file("s.yaml"), "--out", folder_.file(part), "--shard",
                           std::string(part) + "/2", "--quiet"})
                  .status,
              0);
  const CommandRun merged =
      run_command({"compare", "merge", folder_.file("1"), folder_.file("2"), "--out", folder_.file("all")});
  EXPECT_EQ(merged.status, 2);
  EXPECT_EQ(merged.log, whole.log);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "all"));
}

}  // namespace compare_session_test
}  // namespace clearway
