#include "apps/results/compare_records.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace compare_records_test {

CompareAsked asked(CompareShard shard = {}) {
  CompareAsked asked;
  asked.results.suite = "s";
  asked.results.seed = 18446744073709551615U;
  asked.results.version = "1";
  asked.suite_sha256 = "00";
  asked.shard = shard;
  CompareExperiment& experiment = asked.results.experiments.emplace_back();
  experiment.setup.name = "e";
  experiment.setup.padding = 0.1;
  experiment.time_limit = std::numeric_limits<double>::infinity();
  experiment.planners = {{"one", "beam", {{"width", "1"}}, true}, {"two", "rrtconnect", {}, false}};
  return asked;
}

CompareProblem problem(const std::string& name) {
  CompareProblem found;
  found.name = name;
  found.start = Eigen::Vector2d(0.1, -0.0);
  found.goals = {Eigen::Vector2d(1.0 / 3.0, 1e-300)};
  return found;
}

CompareRun run(std::size_t planner, int number) {
  CompareRun found;
  found.planner = planner;
  found.number = number;
  found.cost = 0.1 + 0.2;
  found.min_clearance = std::numeric_limits<double>::infinity();
  found.length = std::numeric_limits<double>::quiet_NaN();
  found.explanation = "Line one.\nLine \"two\": äöü";
  found.statistics = {{"xi_m", 1e-17}};
  found.solved_by = BoundaryPlusStage::none;
  found.work = {.search = 1e-3 / 3.0, .proofs = 2e-17};
  found.motion = CompareMotion{1.0, 2.0, 3.0};
  found.team = CompareTeamRun{1, 2, 3, 4, "who"};
  found.ended = number == 2 ? "hung" : "";
  return found;
}

TEST(CompareRecords, ReadBackAreWhatWasWrittenBitForBit) {
  std::string lines;
  CompareRecords records(asked({2, 3}), [&](const std::string& line) { lines += line; });
  records.open(0, 1, {problem("a"), problem("b")});
  records.add(0, 1, 1, run(1, 2));
  records.add(0, 1, 1, run(0, 1));
  records.finish(0, 1, 1, "animations/b.html");
  records.add_time(2.5);
  const TemporaryFolder folder;
  const CompareRecords read = CompareRecords::read(folder.write("runs.jsonl", lines));
  EXPECT_EQ(read.text(), records.text());
  EXPECT_EQ(read.asked().shard.index, 2);
  EXPECT_EQ(difference(read.asked(), records.asked()), "");
  const CompareExperiment found = read.experiment(0);
  ASSERT_EQ(found.problems.size(), 1U) << "a problem without a run is left out";
  ASSERT_EQ(found.problems[0].runs.size(), 2U);
  const CompareRun &first = found.problems[0].runs[0], &second = found.problems[0].runs[1];
  EXPECT_EQ(first.planner, 0U);
  EXPECT_EQ(second.ended, "hung");
  EXPECT_EQ(first.cost, 0.1 + 0.2);
  EXPECT_TRUE(std::isnan(first.length));
  EXPECT_TRUE(std::isinf(first.min_clearance));
  EXPECT_EQ(first.explanation, run(0, 1).explanation);
  EXPECT_EQ(first.team->outrun, "who");
  EXPECT_EQ(first.statistics, run(0, 1).statistics);
  EXPECT_EQ(first.solved_by, BoundaryPlusStage::none);
  EXPECT_EQ(first.work.search, 1e-3 / 3.0);
  EXPECT_EQ(first.work.shortcuts, std::nullopt);
  EXPECT_EQ(first.work.proofs, 2e-17);
  EXPECT_EQ(found.problems[0].goals[0][1], 1e-300);
  EXPECT_TRUE(std::signbit(found.problems[0].start[1]));
  EXPECT_TRUE(std::isinf(found.time_limit));
  EXPECT_EQ(read.results(folder.path()).time, 2.5);
  EXPECT_EQ(read.results(folder.path()).seed, 18446744073709551615U);
}

TEST(CompareRecords, ALaterRunTakesThePlaceOfAnEarlierOne) {
  CompareRecords records(asked());
  records.open(0, 0, {problem("a")});
  records.add(0, 0, 0, run(1, 1));
  CompareRun again = run(1, 1);
  again.cost = 7.0;
  records.add(0, 0, 0, again);
  EXPECT_EQ(records.count(), 1U);
  EXPECT_EQ(records.experiment(0).problems[0].runs[0].cost, 7.0);
}

TEST(CompareRecords, HalfALastLineIsLeftOutAndAWrongOneNamed) {
  CompareRecords records(asked());
  records.open(0, 0, {problem("a")});
  records.add(0, 0, 0, run(0, 1));
  records.add(0, 0, 0, run(1, 1));
  std::string text = records.text();
  text.resize(text.rfind('\n'));  // the line of the time
  const TemporaryFolder folder;
  EXPECT_EQ(CompareRecords::read(folder.write("cut.jsonl", text)).count(), 2U);
  const auto complaint_of = [&](const std::string& wrong) -> std::string {
    try {
      CompareRecords::read(folder.write("wrong.jsonl", wrong));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint_of(records.text() + "{\"of\":[0,0,7],\"run\":{}}\n").find("wrong.jsonl', line 6"),
            std::string::npos)
      << complaint_of(records.text() + "{\"of\":[0,0,7],\"run\":{}}\n");
  std::string flat = records.text();  // gravity along two axes alone
  const std::size_t gravity = flat.find("\"gravity\":[") + 11;
  flat.erase(gravity, flat.find(',', gravity) + 1 - gravity);
  EXPECT_NE(complaint_of(flat).find("wrong.jsonl', line"), std::string::npos) << complaint_of(flat);
  EXPECT_NE(complaint_of("nonsense\n").find("line 1"), std::string::npos);
  EXPECT_NE(complaint_of("").find("line 1"), std::string::npos);
}

TEST(CompareRecords, FilesElsewhereAndWhatIsNoFileAreRefused) {
  const TemporaryFolder folder;
  const auto is_read = [&](const std::string& plan, const std::string& page) {
    CompareRecords records(asked());
    records.open(0, 0, {problem("a")});
    CompareRun found = run(0, 1);
    found.plan_file = plan;
    records.add(0, 0, 0, found);
    records.finish(0, 0, 0, page);
    try {
      CompareRecords::read(folder.write("runs.jsonl", records.text()));
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  };
  EXPECT_TRUE(is_read("plans/e/a/one.json", "animations/e/a.html"));
  EXPECT_TRUE(is_read("", ""));
  for (const char* elsewhere : {"/tmp/plan.json", "../plans/a.json", "plans/../../a.json",
                                "plans/a/../b.json", "results.html", "plans/a.sh", "./plans/a.json"}) {
    EXPECT_FALSE(is_read(elsewhere, "")) << elsewhere;
    EXPECT_FALSE(is_read("", elsewhere)) << elsewhere;
  }
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(CompareRecords::read(pipe), std::invalid_argument);  // and does not wait for a writer
  EXPECT_THROW(CompareRecords::read(folder.write("deep", std::string(1'000'000, '['))),
               std::invalid_argument);
}

TEST(CompareRecords, NamesWhatTwoComparisonsDoNotShare) {
  const auto with = [](const auto& change) {
    CompareAsked other = asked();
    change(other);
    return difference(asked(), other);
  };
  EXPECT_EQ(with([](CompareAsked& a) { a.results.host = "elsewhere"; }), "");
  EXPECT_EQ(with([](CompareAsked& a) { a.shard = {1, 9}; }), "");
  EXPECT_EQ(with([](CompareAsked& a) { a.results.experiments[0].robot_file = "/elsewhere"; }), "");
  EXPECT_NE(with([](CompareAsked& a) { a.results.commit = "c"; }).find("version"), std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) { a.suite_sha256 = "01"; }).find("suite's file"), std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) { a.results.seed = 2; }).find("seed"), std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) { a.results.experiments[0].planners.pop_back(); }).find("planners of"),
            std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) {
              a.results.experiments[0].planners[0].options["width"] = "2";
            }).find("settings of experiment 'e'"),
            std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) { a.results.experiments[0].time_limit = 1; }).find("time limit"),
            std::string::npos);
  EXPECT_NE(with([](CompareAsked& a) { a.results.experiments[0].robot_sha256 = "01"; }).find("the robot of"),
            std::string::npos);
  EXPECT_NE(
      with([](CompareAsked& a) { a.results.experiments[0].problems_sha256 = "01"; }).find("the problems of"),
      std::string::npos);
}

TEST(CompareShards, ShareOutEveryProblemOnce) {
  for (const int count : {1, 2, 3, 7, 100}) {
    for (std::size_t e = 0; e < 3; ++e)
      for (std::size_t s = 0; s < 5; ++s)
        for (std::size_t i = 0; i < 20; ++i) {
          int shards = 0;
          for (int index = 1; index <= count; ++index) shards += is_in({index, count}, e, s, i);
          EXPECT_EQ(shards, 1);
        }
  }
}

TEST(CompareRecords, APipeIsRefusedWithoutWaitingForIt) {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("runs.jsonl");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string why = "' cannot be read: it is a pipe, expected a regular file";
  EXPECT_EQ(complaint([&] { CompareRecords::read(pipe); }), "records of runs '" + pipe + why);
  CompareExperiment experiment = asked().results.experiments[0];
  experiment.setup.plots = {"profiles"};
  experiment.problems = {problem("a")};
  experiment.problems[0].runs = {run(0, 1)};
  experiment.problems[0].runs[0].plan_file = "runs.jsonl";
  EXPECT_EQ(complaint([&] { profiles_of(experiment, folder.path()); }), "plan file '" + pipe + why);
}

}  // namespace compare_records_test
}  // namespace clearway
