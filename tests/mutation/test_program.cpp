#include "tests/mutation/test_program.hpp"

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <stdexcept>
#include <thread>

#include "tests/worlds/trials.hpp"

namespace clearway::mutation {
namespace {

namespace fs = std::filesystem;

/// The test that failed, or was running when the program ended, or all tests of a suite that could not be set
/// up.
std::string failed_test(const std::string& output) {
  std::smatch match;
  if (std::regex_search(output, match, std::regex("\\[  FAILED  \\] ([^ ,\n]+): SetUpTestSuite")))
    return match[1].str() + ".*";
  if (std::regex_search(output, match, std::regex("\\[  FAILED  \\] ([^ ,\n]+/?[^ ,\n]*)"))) return match[1];
  std::string last;
  const std::regex runs("\\[ RUN      \\] ([^ \n]+)");
  for (std::sregex_iterator it(output.begin(), output.end(), runs), end; it != end; ++it) last = (*it)[1];
  return last;
}

/// Those of a run that goes on behind them.
std::set<std::string> failed_tests(const std::string& output) {
  std::set<std::string> tests;
  const std::regex failed("\\[  FAILED  \\] ([^ ,\n]+\\.[^ ,\n]+)");
  for (std::sregex_iterator it(output.begin(), output.end(), failed), end; it != end; ++it)
    tests.insert((*it)[1]);
  return tests;
}

const std::string with_many = " (with many cases)";

std::string no_more(std::size_t /*shard*/) { return ""; }

std::string word(Trials trials) { return trials == Trials::many ? "many" : "few"; }

bool is_near(const Stage& stage) { return stage.name == "nearest" || stage.name == "folder"; }

}  // namespace

std::string to_string(Outcome::Kind kind) {
  return kind == Outcome::Kind::noticed    ? "noticed"
         : kind == Outcome::Kind::survived ? "survived"
         : kind == Outcome::Kind::open     ? "not noticed nearby"
                                           : "not compiled";
}

TestProgram::TestProgram(const fs::path& repository, const fs::path& build, const std::string& floor,
                         Costs& costs)
    : repository_(repository),
      floor_(floor),
      most_trials_(trials(0, 1) == 0 ? Trials::few : Trials::many),
      costs_(costs),
      build_(repository, build, floor, costs) {
  digest_ =
      std::to_string(hash_of(read_whole(build_.program()))) + (most_trials_ == Trials::many ? "many" : "");
}

Ended TestProgram::run(const Run& what, const fs::path& folder) const {
  const fs::path scratch = folder / "scratch";
  fs::remove_all(scratch);
  const Limits limits{.cpu = 10.0 + 4.0 * what.usual.value_or(0.0),
                      .wall = 60.0 + 10.0 * what.usual.value_or(10.0)};
  const std::string environment = "CLEARWAY_DATASETS=" + quoted(repository_ / "datasets") +
                                  " CLEARWAY_TRIALS=" + word(what.trials) + " " + what.environment;
  Ended ended = run_command("exec env " + environment + " " + quoted(what.program) +
                                (what.ends_at_first ? " --gtest_fail_fast" : "") + " --gtest_filter='" +
                                what.filter + "'",
                            scratch, limits);
  fs::remove_all(scratch);
  return ended;
}

template <typename Environment>
double TestProgram::run_faultless(const Run& what, const Environment& environment,
                                  const fs::path& folder) const {
  std::vector<Ended> ended(std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < ended.size(); ++i) {
    Run shard = what;
    shard.environment = "GTEST_TOTAL_SHARDS=" + std::to_string(ended.size()) +
                        " GTEST_SHARD_INDEX=" + std::to_string(i) + environment(i);
    threads.emplace_back([&, shard, i] { ended[i] = run(shard, folder / ("shard" + std::to_string(i))); });
  }
  for (std::thread& thread : threads) thread.join();
  double time = 0.0;
  for (const Ended& one : ended) {
    time += one.cpu;
    std::set<std::string> failed = failed_tests(one.output);
    if (!one.is_good() && failed.empty()) failed.insert(failed_test(one.output));
    for (const std::string& test : failed) {  // one that depends on the machine's mood passes now
      Run again{what.program, test, environment(0), what.trials, what.usual};
      if (!run(again, folder).is_good())
        throw std::runtime_error("without any fault the tests of " + floor_ + " fail in " + test +
                                 ", expected them to pass");
    }
  }
  costs_.add("tests without a fault", time);
  return time;
}

fs::path TestProgram::faultless(const fs::path& folder) const {
  const fs::path program = folder / "faultless";
  fs::create_directories(folder);
  fs::remove(program);
  fs::create_hard_link(build_.program(), program);
  return program;
}

double TestProgram::usual_time(const Stage& stage, const fs::path& folder) {
  const std::lock_guard lock(mutex_);
  // The floor's others are different ones for each source: all are measured, once.
  const std::string filter = stage.filter.starts_with('-') ? "*" : stage.filter;
  const std::string key = word(stage.trials) + " " + filter;
  if (const auto known = usual_.find(key); known != usual_.end()) return known->second;
  return usual_[key] =
             run_faultless({faultless(folder), filter, "", stage.trials, 600.0, false}, no_more, folder);
}

void TestProgram::verify(const std::vector<Outcome>& outcomes, const fs::path& folder) const {
  std::map<Trials, std::string> filters;
  for (const Outcome& outcome : outcomes) {
    if (outcome.kind != Outcome::Kind::noticed || outcome.by.find('.') == std::string::npos) continue;
    std::string& filter = filters[outcome.by.ends_with(with_many) ? Trials::many : Trials::few];
    filter += (filter.empty() ? "" : ":") + outcome.by.substr(0, outcome.by.find(' '));
  }
  for (const auto& [trials, filter] : filters)
    run_faultless({faultless(folder), filter, "", trials, 600.0, false}, no_more, folder);
}

Outcome TestProgram::tested(Run what, const Stage& stage, const fs::path& folder) {
  const std::string tail = stage.trials == Trials::many ? with_many : "";
  for (int repeat = 0; repeat < 4; ++repeat) {
    Ended ended = run(what, folder);
    costs_.add("tests: " + stage.name, ended.cpu);
    if (ended.is_late && !what.usual) {
      what.usual = usual_time(stage, folder);
      ended = run(what, folder);
      costs_.add("tests: " + stage.name, ended.cpu);
    }
    if (ended.is_good()) break;
    const std::string test = failed_test(ended.output);
    if (ended.is_late) return {Outcome::Kind::noticed, test + " (takes too long)" + tail};
    if (ended.signal != 0) return {Outcome::Kind::noticed, test + " (crashes)" + tail};
    if (test.empty()) return {Outcome::Kind::noticed, "the program does not start"};
    const Ended again = run({what.program, test, "", what.trials, what.usual}, folder);
    costs_.add("tests: once more", again.cpu);
    if (!again.is_good()) return {Outcome::Kind::noticed, test + tail};
    what.filter += (what.filter.find('-') == std::string::npos ? "-" : ":") + test;  // the machine's mood
  }
  return {Outcome::Kind::survived, ""};
}

Outcome TestProgram::tried_nearby(const Candidate& candidate, const fs::path& folder) {
  const Ended built = build_.build(candidate, folder);
  if (!built.is_good()) {
    std::smatch error;
    std::regex_search(built.output, error, std::regex("error: ([^\n]*)"));
    return {Outcome::Kind::not_compiled, error.size() > 1 ? error[1].str() : "compiler ended"};
  }
  bool are_all_near = true;
  for (const Stage& stage : stages_for(repository_, candidate.file)) {
    are_all_near = are_all_near && is_near(stage);
    if (!is_near(stage)) continue;
    Outcome outcome = tested({folder / "tests", stage.filter, "", stage.trials, {}}, stage, folder);
    if (outcome.kind == Outcome::Kind::noticed) return outcome;
  }
  return {are_all_near ? Outcome::Kind::survived : Outcome::Kind::open, ""};
}

void TestProgram::find_reach(const std::vector<Candidate>& open, const fs::path& folder) {
  if (floor_ == "apps" || open.empty()) return;  // of which no other folder's tests are run
  for (const int number : build_.build_with_probes(open, folder))
    probes_[open[static_cast<std::size_t>(number)].name()] = number;
  std::map<Trials, std::string> filters{{Trials::few, "*"}};
  for (const Stage& stage : stages_for(repository_, open.front().file))  // the same for all of them
    if (stage.trials == Trials::many && most_trials_ == Trials::many) filters[Trials::many] = stage.filter;
  for (const auto& [trials, filter] : filters) {
    const auto told = [&](std::size_t shard) {
      return folder / ("reached_" + word(trials) + std::to_string(shard));
    };
    run_faultless(
        {folder / "tests", filter, "", trials, 600.0, false},
        [&](std::size_t shard) { return " CLEARWAY_REACHED=" + quoted(told(shard)); }, folder);
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
      reach_[trials].read(told(i));
  }
}

std::pair<std::string, std::optional<double>> TestProgram::reaching(const Candidate& candidate,
                                                                    const Stage& stage) const {
  const auto reach = reach_.find(stage.trials);
  const auto probe = probes_.find(candidate.name());
  std::string filter;
  double usual = 0.0;
  if (reach == reach_.end()) return {stage.filter, std::nullopt};
  const bool is_probed = probe != probes_.end();
  const auto suites = is_probed ? reach->second.suites.find(probe->second) : reach->second.suites.end();
  if (is_probed && suites == reach->second.suites.end()) return {"", 0.0};
  const bool are_all = !is_probed || suites->second.contains("*");
  for (const auto& [suite, time] : reach->second.times) {
    if (suite == "*" || !(are_all || suites->second.contains(suite))) continue;
    filter += (filter.empty() ? "" : ":") + suite + ".*";
    usual += time;
  }
  return {filter + (stage.filter.starts_with('-') ? stage.filter : ""), usual};
}

Outcome TestProgram::tried_by_others(const Candidate& candidate, const fs::path& folder) {
  build_.build(candidate, folder);
  bool is_run = false;
  for (const Stage& stage : stages_for(repository_, candidate.file)) {
    if (is_near(stage) || (stage.trials == Trials::many && most_trials_ == Trials::few)) continue;
    auto [filter, usual] = reaching(candidate, stage);
    if (filter.empty()) continue;
    is_run = true;
    Outcome outcome = tested({folder / "tests", filter, "", stage.trials, usual}, stage, folder);
    if (outcome.kind == Outcome::Kind::noticed) return outcome;
  }
  return {Outcome::Kind::survived, is_run ? "" : "no test of the floor runs the place"};
}

}  // namespace clearway::mutation
