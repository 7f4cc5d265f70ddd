// Comparisons in parts: interrupted and resumed, cut into shards and merged, one run alone, two results.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_suite.hpp"
#include "tests/worlds/trials.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace compare_parts_test {

namespace fs = std::filesystem;

/// What is found, by file: plans without times and places, runs without times.
std::map<std::string, std::string> findings(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (!entry.is_regular_file() || name[0] == '.') continue;
    if (name.starts_with("worst/")) continue;  // which runs are slowest is a matter of times
    std::string& found = all[name];
    if (name.ends_with(".json")) {
      auto plan = nlohmann::json::parse(read_file(entry.path()));
      plan.erase("time_s");
      plan.at("map").at("file") = fs::path(plan.at("map").at("file").get<std::string>()).filename();
      found = plan.dump();
    } else if (name == "runs.jsonl") {
      std::istringstream lines(read_file(entry.path()));
      std::string line;
      std::getline(lines, line);  // machine and date
      while (std::getline(lines, line)) {
        auto json = nlohmann::json::parse(line);
        if (json.contains("time_s")) continue;
        if (json.contains("run"))
          for (const char* time : {"time", "cpu", "search_cpu", "shortcut_cpu", "proof_cpu", "space_cpu",
                                   "derive_cpu", "check_time", "check_cpu", "motion_cpu"})
            json.at("run").erase(time);
        if (json.contains("problems"))
          for (auto& problem : json.at("problems"))
            problem.at("map_file") = fs::path(problem.at("map_file").get<std::string>()).filename();
        found += json.dump() + "\n";
      }
    } else if (name.ends_with(".ot")) {
      found = read_file(entry.path());
    }
  }
  return all;
}

std::string many_runs(int runs = 5) {
  std::string suite = small_suite;
  return suite.replace(suite.find("runs: 2"), 7, "runs: " + std::to_string(runs));
}

class CompareParts : public testing::Test {
 protected:
  void SetUp() override { folder_.write("small.yaml", small_suite); }

  CommandRun compare(std::vector<std::string> flags) const {
    if (flags.front() != "merge") flags.insert(flags.end(), {"--worst-pages", worst_pages_});
    flags.insert(flags.begin(), "compare");
    flags.emplace_back("--quiet");
    return run_command(flags);
  }
  CommandRun shard(const std::string& part, const std::string& out) const {
    return compare({folder_.file("small.yaml"), "--out", folder_.file(out), "--shard", part});
  }
  void expect_same(const std::string& one, const std::string& other) const {
    const auto expected = findings(folder_.path() / one), found = findings(folder_.path() / other);
    for (const auto& [name, text] : expected) {
      ASSERT_TRUE(found.contains(name)) << name;
      EXPECT_EQ(found.at(name), text) << name;
    }
    EXPECT_EQ(found.size(), expected.size());
  }

  TemporaryFolder folder_;
  std::string worst_pages_ = "0";  ///< they take longer than the runs
};

/// Starts the program, and sends it the signal when it has written so many lines.
struct Interrupted {
  int status = 0;
  std::string out, log;
};
Interrupted interrupt(const std::vector<std::string>& arguments, int signal, const fs::path& records,
                      std::ptrdiff_t lines, const fs::path& scratch) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(signal, SIG_DFL);  // shells let what runs behind them ignore SIGINT
    std::freopen((scratch / "out.txt").c_str(), "w", stdout);
    std::freopen((scratch / "log.txt").c_str(), "w", stderr);
    std::vector<char*> pointers{const_cast<char*>(CLEARWAY_BINARY)};
    for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    ::execv(CLEARWAY_BINARY, pointers.data());
    ::_exit(99);
  }
  for (int wait = 0; wait < 6000; ++wait) {
    const std::string text = read_file(records);
    if (std::count(text.begin(), text.end(), '\n') >= lines) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(child, signal);
  Interrupted ended;
  ::waitpid(child, &ended.status, 0);
  ended.out = read_file(scratch / "out.txt");
  ended.log = read_file(scratch / "log.txt");
  return ended;
}

TEST_F(CompareParts, ASignalLeavesATableAndResumingFindsWhatNobodyInterrupted) {
  folder_.write("small.yaml", many_runs());
  const std::vector<std::string> asked = {folder_.file("small.yaml"), "--out", folder_.file("out"),
                                          "--quiet"};
  const fs::path partial = folder_.path() / "out.partial";
  ASSERT_EQ(compare({asked[0], "--out", folder_.file("whole")}).status, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    std::vector<std::string> arguments = asked;
    arguments.insert(arguments.begin(), "compare");
    arguments.emplace_back("--resume");  // the second time
    const Interrupted ended =
        interrupt(arguments, signal, partial / "runs.jsonl", signal == SIGINT ? 8 : 25, folder_.path());
    ASSERT_TRUE(WIFEXITED(ended.status));
    EXPECT_EQ(WEXITSTATUS(ended.status), 128 + signal) << ended.log;
    EXPECT_NE(ended.out.find("solved / valid / total"), std::string::npos) << ended.out;
    EXPECT_NE(ended.log.find("--resume goes on"), std::string::npos) << ended.log;
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
    for (const char* name : {"results.csv", "results.sqlite", "results.log", "report.html", "runs.jsonl"})
      EXPECT_TRUE(fs::exists(partial / name)) << name;
  }
  const std::string kept = read_file(partial / "runs.jsonl");
  const CommandRun anew = compare(asked);
  EXPECT_EQ(anew.status, exit_bad_input);
  EXPECT_TRUE(anew.complains_in_one_sentence()) << anew.log;
  EXPECT_NE(anew.log.find("of a comparison that did not end, expected --resume"), std::string::npos)
      << anew.log;
  EXPECT_EQ(read_file(partial / "runs.jsonl"), kept);
  std::ofstream(partial / "runs.jsonl", std::ios::app) << "{\"of\":[0,0,";  // a kill in the middle of a line
  std::vector<std::string> rest = asked;
  rest.emplace_back("--resume");
  const CommandRun resumed = compare(rest);
  EXPECT_EQ(resumed.status, 0) << resumed.log;
  EXPECT_FALSE(fs::exists(partial));
  expect_same("whole", "out");

  const fs::path records = folder_.path() / "out" / "runs.jsonl";  // once more: nothing is left
  const auto written = fs::last_write_time(records);
  std::vector<std::string> talking = rest;
  std::erase(talking, "--quiet");
  talking.insert(talking.begin(), "compare");
  const CommandRun again = run_command(talking);
  EXPECT_EQ(again.status, 0) << again.log;
  EXPECT_NE(again.log.find("out' is finished: nothing was left to run"), std::string::npos) << again.log;
  EXPECT_NE(again.out.find("solved / valid / total"), std::string::npos) << again.out;
  EXPECT_EQ(fs::last_write_time(records), written);
  const std::string lines = read_file(records);  // cut by somebody: then all is run anew
  folder_.write("out/runs.jsonl", lines.substr(0, lines.find('\n', lines.size() / 2) + 1));
  EXPECT_EQ(compare(rest).status, 0);
  expect_same("whole", "out");
  const auto rewritten = fs::last_write_time(records);
  rest.insert(rest.end(), {"--seed", "7"});
  const CommandRun other = compare(rest);
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.log.find("it differs in the seed (7, not 3)"), std::string::npos) << other.log;
  EXPECT_EQ(fs::last_write_time(records), rewritten);
}

TEST_F(CompareParts, ResumingAnotherComparisonIsRefusedAndNothingIsLost) {
  const std::string more_than_end_before_the_signal = many_runs(500);
  folder_.write("small.yaml", more_than_end_before_the_signal);
  const std::vector<std::string> asked = {"compare", folder_.file("small.yaml"), "--out",
                                          folder_.file("out")};
  const fs::path records = folder_.path() / "out.partial" / "runs.jsonl";
  interrupt(asked, SIGINT, records, 8, folder_.path());
  const std::string before = read_file(records);
  ASSERT_FALSE(before.empty());
  const auto refused = [&](std::vector<std::string> flags, const std::string& because) {
    flags.insert(flags.begin(), {folder_.file("small.yaml"), "--out", folder_.file("out"), "--resume"});
    const CommandRun run = compare(flags);
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(because), std::string::npos) << run.log;
    EXPECT_EQ(read_file(records), before);
  };
  refused({"--seed", "7"}, "the seed (7, not 3)");
  refused({"--planners", "rrtconnect"}, "the planners of experiment 'round'");
  refused({"--time-limit", "3"}, "the time limit");
  refused({"--experiments", "round"}, "the experiments");
  refused({"--shard", "1/2"}, "the same --shard");
  folder_.write("small.yaml", more_than_end_before_the_signal + "\n# changed\n");
  refused({}, "the suite's file");
}

TEST_F(CompareParts, AnyPartitionMergesToWhatTheWholeRunFinds) {
  worst_pages_ = "1";
  ASSERT_EQ(compare({folder_.file("small.yaml"), "--out", folder_.file("whole")}).status, 0);
  for (int count = 5; count >= trials(5, 1); count -= 2) {  // some with more runs than others
    std::vector<std::string> merge = {"merge"};
    for (int index = count; index >= 1; --index) {
      const std::string name = "part" + std::to_string(index) + "of" + std::to_string(count);
      ASSERT_EQ(shard(std::to_string(index) + "/" + std::to_string(count), name).status, 0);
      merge.push_back(folder_.file(name));
    }
    merge.insert(merge.end(), {"--out", folder_.file("merged")});
    const CommandRun merged = compare(merge);
    EXPECT_EQ(merged.status, 0) << merged.log;
    EXPECT_NE(merged.out.find("rrtconnect   4 / 4 / 6"), std::string::npos) << merged.out;
    expect_same("whole", "merged");
    EXPECT_TRUE(fs::exists(folder_.path() / "merged/worst/swing/swing.html")) << "of the shard that drew it";
    EXPECT_NE(read_file(folder_.path() / "merged/report.html").find("worst/swing/swing.html#plan=1"),
              std::string::npos);
  }
}

TEST_F(CompareParts, WhatMergingCopiesIsNotWaitedForWhenItIsAPipe) {
  ASSERT_EQ(shard("1/1", "whole").status, 0);
  std::map<std::string, fs::path> first;  // of the records, plans, pages and maps
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / "whole"))
    if (entry.is_regular_file()) first[entry.path().extension()] = entry.path();
  for (const char* kind : {".jsonl", ".json", ".ot"}) {
    ASSERT_TRUE(first.contains(kind)) << kind;
    const fs::path file = first[kind], aside = folder_.path() / "aside";
    fs::rename(file, aside);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    const CommandRun merged = compare({"merge", folder_.file("whole"), "--out", folder_.file("merged")});
    EXPECT_EQ(merged.status, 2);
    EXPECT_TRUE(merged.complains_in_one_sentence()) << merged.log;
    EXPECT_NE(merged.log.find(file.filename().string() + "' cannot be read: it is a pipe"), std::string::npos)
        << merged.log;
    EXPECT_FALSE(fs::exists(folder_.path() / "merged"));
    fs::rename(aside, file);
  }
  EXPECT_EQ(compare({"merge", folder_.file("whole"), "--out", folder_.file("merged")}).status, 0);
}

/// A suite names its robots, maps and problems by files: other ones there are of another comparison.
TEST_F(CompareParts, ShardsOnAnotherMapRobotOrProblemAreOfAnotherComparison) {
  const auto write_map = [&](float x) {
    FreeSpaceMap map({.resolution = 0.1});
    Scan scan;
    scan.points = {{x, 3.0F, 3.0F}};
    map.insert(scan);
    save_map(map.snapshot(), folder_.path() / "map");
  };
  const auto write_problems = [&](const std::string& goal) {
    folder_.write("problems.yaml",
                  "problems:\n  - {name: a, start: [0, 0, 0], goals: [[0.5, 0, 0]]}\n"
                  "  - {name: b, start: [0, 0, 0], goals: [[" +
                      goal + ", 0, 0]]}\n");
  };
  folder_.write(
      "small.yaml",
      "worlds: [{name: w, map: map}]\nexperiments:\n  - name: e\n    robot: arm.urdf\n    world: w\n"
      "    problems: problems.yaml\n    policies: {default: not_occupied}\n"
      "    planners: [{planner: rrtconnect}]\n");
  const auto merged = [&] {
    const CommandRun run =
        compare({"merge", folder_.file("1"), folder_.file("2"), "--out", folder_.file("m")});
    EXPECT_EQ(run.status == 2, run.complains_in_one_sentence()) << run.log;
    fs::remove_all(folder_.path() / "m");
    fs::remove_all(folder_.path() / "2");
    return run.log;
  };
  write_map(3.0F);
  write_problems("0.4");
  const std::string arm = worlds::arm_with_finger();
  folder_.write("arm.urdf", arm);
  const CommandRun first = shard("1/2", "1");
  ASSERT_EQ(first.status, 0) << first.log;
  EXPECT_EQ(read_file(folder_.file("1/results.csv")).find(",nan"), std::string::npos)
      << "the arm has no masses, so that its costs are not known";
  ASSERT_EQ(shard("2/2", "2").status, 0);
  const std::string merging = merged();
  EXPECT_EQ(merging,
            "note: The robot's file gives link 'lower' and 1 other that move no mass (<inertial>), so "
            "costs of robot '" +
                folder_.file("arm.urdf") + "' are not known\n");

  folder_.write("more.yaml",
                read_file(folder_.file("small.yaml")) +
                    "  - {name: other, robot: point, world: gone, problems: [{name: a, start: [0, "
                    "0], goals: [[1, 0]]}], planners: [{planner: rrtconnect}]}\n");
  std::string more = read_file(folder_.file("more.yaml"));
  more.replace(more.find("{name: w, map: map}"), 19, "{name: w, map: map}, {name: gone, map: gone.bt}");
  const CommandRun chosen =
      compare({folder_.write("more.yaml", more), "--out", folder_.file("chosen"), "--experiments", "e"});
  EXPECT_EQ(chosen.status, 0) << "a map that no chosen experiment needs: " << chosen.log;

  write_map(3.5F);
  ASSERT_EQ(shard("2/2", "2").status, 0);
  EXPECT_NE(merged().find("the map of world 'w'"), std::string::npos);

  write_map(3.0F);
  std::string other = arm;
  other.replace(other.find("0.4 0 0"), 7, "0.5 0 0");
  folder_.write("arm.urdf", other);
  ASSERT_EQ(shard("2/2", "2").status, 0);
  EXPECT_NE(merged().find("the robot of experiment 'e'"), std::string::npos);

  folder_.write("arm.urdf", arm);
  write_problems("0.45");
  ASSERT_EQ(shard("2/2", "2").status, 0);
  EXPECT_NE(merged().find("the problems of experiment 'e'"), std::string::npos);
}

TEST_F(CompareParts, LostDoubledAndForeignShardsAreNamed) {
  for (const char* part : {"1", "2", "3"}) ASSERT_EQ(shard(std::string(part) + "/3", part).status, 0);
  ASSERT_EQ(
      compare({folder_.file("small.yaml"), "--out", folder_.file("other"), "--shard", "3/3", "--seed", "9"})
          .status,
      0);
  const auto refused = [&](const std::vector<std::string>& folders, const std::string& because) {
    std::vector<std::string> arguments = {"merge"};
    for (const std::string& name : folders) arguments.push_back(folder_.file(name));
    arguments.insert(arguments.end(), {"--out", folder_.file("merged")});
    const CommandRun run = compare(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(because), std::string::npos) << run.log;
    EXPECT_FALSE(fs::exists(folder_.path() / "merged"));
  };
  refused({"1", "3"}, "of 3 shards 1 missing: 2");
  refused({"1", "2", "2", "3"}, "shard 2/3 is given twice");
  refused({"1", "2", "other"}, "the seed (3, not 9)");
  refused({"1", "2", "nowhere"}, "has no runs.jsonl");
  refused({}, "expected the folders of all shards");
  std::string text = read_file(folder_.path() / "2" / "runs.jsonl");
  text.resize(text.rfind("{\"of\"", text.rfind("\"page\"")));  // a problem's end
  folder_.write("2/runs.jsonl", text);
  refused({"1", "2", "3"}, "is not whole: problem ");
}

TEST_F(CompareParts, OneRunIsRepeatedByItsId) {
  ASSERT_EQ(compare({folder_.file("small.yaml"), "--out", folder_.file("whole")}).status, 0);
  const CommandRun run = compare(
      {folder_.file("small.yaml"), "--rerun", "round/there_and_back/coarse-2", "--out", folder_.file("one")});
  EXPECT_EQ(run.status, 1) << "its path is refused";
  EXPECT_NE(run.out.find("refused"), std::string::npos) << run.out;
  const std::string plan = "plans/round/there_and_back/coarse-2.json";
  const auto all = findings(folder_.path() / "whole"), one = findings(folder_.path() / "one");
  ASSERT_TRUE(one.contains(plan));
  EXPECT_EQ(one.at(plan), all.at(plan));
  EXPECT_EQ(compare({folder_.file("small.yaml"), "--rerun", "swing/swing/beam"}).status, 0);
  const auto refused = [&](const std::string& id, const std::string& because) {
    const CommandRun wrong = compare({folder_.file("small.yaml"), "--rerun", id});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_TRUE(wrong.complains_in_one_sentence()) << wrong.log;
    EXPECT_NE(wrong.log.find(because), std::string::npos) << wrong.log;
  };
  refused("swing", "expected EXPERIMENT/PROBLEM/PLANNER");
  refused("swign/swing/beam", "did you mean 'swing'?");
  refused("swing/swing/bream", "did you mean 'beam'?");
  refused("round/there_and_back/mine-2", "An external planner needs its --external NAME=COMMAND here, too.");
  refused("swing/swnig/beam", "no problem 'swnig': did you mean 'swing'?");
  refused("round/nowhere/coarse-1", "no problem 'nowhere': expected one of there, there_and_back, blocked");
}

TEST_F(CompareParts, ARunOfAPlannerThatOnlyAFlagNamedIsRepeatedByItsId) {
  const std::string suite = folder_.file("small.yaml");
  ASSERT_EQ(compare({suite, "--planners", "auto", "--out", folder_.file("whole")}).status, 0);
  const auto all = findings(folder_.path() / "whole");
  std::size_t repeated = 0;
  for (const auto& [name, plan] : all) {
    if (!name.starts_with("plans/")) continue;
    const std::string id = name.substr(6, name.size() - 11);  // the page shows the same, as --rerun takes it
    EXPECT_NE(read_file(folder_.path() / "whole/report.html").find(id), std::string::npos) << id;
    const std::string out = folder_.file("one" + std::to_string(repeated++));
    const CommandRun run = compare({suite, "--rerun", id, "--out", out});
    EXPECT_NE(run.status, exit_bad_input) << run.log;  // not every path is valid
    ASSERT_TRUE(findings(out).contains(name)) << name;
    EXPECT_EQ(findings(out).at(name), plan) << name;
  }
  EXPECT_GT(repeated, 1U);
}

/// As projects are laid out: the suite beside the folder of its maps, where results have theirs.
TEST_F(CompareParts, TheMapsOfASuiteDoNotMakeWayForItsResults) {
  const std::string project = folder_.file("project"), hall = project + "/maps/hall";
  fs::create_directories(hall);
  save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), hall);
  const std::string map = read_file(hall + "/map.ot");
  folder_.write("project/suite.yaml", R"(
worlds: [{name: hall, map: maps/hall}]
experiments:
  - name: e
    robot: point
    world: hall
    problems: [{name: a, start: [0.2, 0], goals: [[2, 0]]}]
    policies: {default: not_occupied}
    planners: [{planner: rrtconnect}]
)");
  const CommandRun run = compare({project + "/suite.yaml", "--out", project});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  EXPECT_NE(run.log.find("the map of world 'hall'"), std::string::npos) << run.log;
  EXPECT_EQ(read_file(hall + "/map.ot"), map);
  fs::create_directory(project + "/plans");
  folder_.write("project/plans/keep.json", "{}");
  EXPECT_EQ(compare({project + "/suite.yaml", "--out", project + "/results"}).status, exit_done);
  EXPECT_EQ(read_file(project + "/plans/keep.json"), "{}");
}

TEST_F(CompareParts, FlagsThatContradictAreRefused) {
  const auto refused = [&](const std::vector<std::string>& flags, const std::string& because) {
    const CommandRun run = compare(flags);
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(because), std::string::npos) << run.log;
  };
  const std::string suite = folder_.file("small.yaml"), out = folder_.file("out");
  refused({suite}, "--out is required");
  refused({suite, "--out", out, "--isolate", "no", "--jobs", "2"}, "expected --jobs 1");
  refused({suite, "--out", out, "--isolate", "maybe"}, "expected yes or no");
  for (const char* part : {"0/3", "4/3", "1", "1/", "a/b", "1/3x", "-1/3", ""})
    refused({suite, "--out", out, "--shard", part}, "expected I/N");
  refused({suite, "second.yaml", "--out", out}, "expected one suite");
  refused({"diff", suite}, "expected two, OLD and NEW");
  refused({"diff", suite, suite}, "expected a results.sqlite");
}

}  // namespace compare_parts_test
}  // namespace clearway
