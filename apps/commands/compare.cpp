#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <ostream>
#include <set>
#include <stdexcept>
#include <thread>

#include "apps/compare/compare_run.hpp"
#include "apps/compare/finished_problems.hpp"
#include "apps/console/build_stamp.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/console/table.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/nearest_name.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// Refuses a chosen name that is not among the known ones.
void require_known(const std::string& flag, const std::vector<std::string>& chosen,
                   const std::vector<std::string>& known) {
  for (const std::string& name : chosen) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw std::invalid_argument(flag + ": the suite has no '" + name + "': did you mean '" +
                                nearest_name(name, known) + "'?");
  }
}

/// Planners that are chosen by name and that no experiment lists run in all but those of teams, by default.
void add_chosen_planners(const std::vector<std::string>& chosen, Suite& suite) {
  for (const std::string& name : chosen) {
    const auto lists = [&](const SuiteExperiment& experiment) {
      return std::any_of(experiment.planners.begin(), experiment.planners.end(),
                         [&](const SuitePlanner& p) { return p.label == name || p.planner == name; });
    };
    const auto& known = planner_table();
    const bool is_planner = std::any_of(known.begin(), known.end(),
                                        [&](const PlannerEntry& planner) { return planner.name == name; });
    if (!is_planner || std::any_of(suite.experiments.begin(), suite.experiments.end(), lists)) continue;
    for (SuiteExperiment& experiment : suite.experiments)
      if (!experiment.teams) experiment.planners.push_back({name, name, {}});
  }
}

Suite chosen_suite(const CompareOptions& options) {
  Suite suite = load_suite(shipped_file("suites", options.suite));
  add_chosen_planners(options.planners, suite);
  std::vector<std::string> names;
  for (const SuiteExperiment& experiment : suite.experiments) names.push_back(experiment.name);
  require_known("--experiments", options.experiments, names);
  if (!options.experiments.empty()) {
    std::erase_if(suite.experiments, [&](const SuiteExperiment& experiment) {
      return std::find(options.experiments.begin(), options.experiments.end(), experiment.name) ==
             options.experiments.end();
    });
  }
  if (options.time_limit) {
    for (SuiteExperiment& experiment : suite.experiments) experiment.time_limit = options.time_limit;
  }
  if (options.seed) suite.seed = *options.seed;
  return suite;
}

/// Every name of every experiment is looked up before anything runs.
std::vector<PreparedExperiment> prepare_all(const Suite& suite, const CompareOptions& options) {
  std::set<std::string> planners;
  std::vector<PreparedExperiment> prepared;
  for (const SuiteExperiment& experiment : suite.experiments) {
    for (const SuitePlanner& planner : experiment.planners) {
      planners.insert(planner.label);
      planners.insert(planner.planner);
    }
    prepared.push_back(prepare(suite, experiment, options.planners));
  }
  require_known("--planners", options.planners, {planners.begin(), planners.end()});
  std::erase_if(prepared, [](const PreparedExperiment& experiment) { return experiment.planners.empty(); });
  for (const PreparedExperiment& experiment : prepared) {  // worlds, generators, numbers of joints
    if (!experiment.setup.teams) SuiteStages(suite, experiment.setup, experiment.robot);
  }
  return prepared;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with("model name") && colon + 2 < line.size()) {
      return line.substr(colon + 2) + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
    }
  }
  return "unknown";
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

CompareResults stamped(const Suite& suite, const CompareOptions& options) {
  CompareResults results;
  results.suite = suite.name;
  results.title = suite.title;
  results.file = options.suite.string();
  results.seed = suite.seed;
  results.jobs = options.jobs;
  results.version = CLEARWAY_VERSION;
  results.commit = build_commit();
  utsname machine{};
  results.host = uname(&machine) == 0 ? machine.nodename : "unknown";
  results.processor = processor_name();
  results.date = utc_now();
  return results;
}

constexpr std::array files = {"results.sqlite", "results.csv", "results.log", "report.html"};

/// For a folder of an older version, which left no list of its files.
bool is_of_comparison(const fs::path& relative) {
  if (std::find(files.begin(), files.end(), relative) != files.end()) return true;
  const fs::path folder = *relative.begin(), kind = relative.extension();
  if (folder == "maps") return relative.filename() == "map.ot" || relative.filename() == "painted.csv";
  if (folder == "plans" || folder == "teams") return kind == ".json" || kind == ".html";
  return folder == "animations" && kind == ".html";
}

void save_results(const CompareResults& results, const fs::path& out) {
  save_database(results, out / files[0]);
  save_file(out / files[1], to_csv(results));
  save_file(out / files[2], to_ompl_log(results));
  save_file(out / files[3], to_html(results));
}

/// Problems and teams that cannot begin or end where they shall, and why; each once, whoever was to plan it.
std::vector<std::string> invalid_ends(const CompareResults& results) {
  std::vector<std::string> sentences;
  for (const CompareExperiment& experiment : results.experiments) {
    for (const CompareProblem& problem : experiment.problems) {
      const auto run = std::find_if(problem.runs.begin(), problem.runs.end(), [](const CompareRun& any) {
        return any.status == PlanStatus::start_invalid || any.status == PlanStatus::goal_invalid;
      });
      if (run == problem.runs.end()) continue;
      sentences.push_back("experiment '" + experiment.setup.name + "', problem '" + problem.name +
                          "': " + run->explanation);
    }
  }
  return sentences;
}

/// Experiment after experiment; what is found is saved after each.
void run_all(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
             const CompareOptions& options, AtomicFolder& folder, CompareResults& results, Console& console) {
  FinishedProblems finished(folder, suite.name);
  const CompareChoice choice{suite.seed,  options.jobs,      folder.path(),
                             options.out, options.keep_maps, &finished};
  for (const PreparedExperiment& experiment : prepared) {
    {
      const Stopwatch watch(results.time);
      results.experiments.push_back(
          run_experiment(suite, experiment, choice, console.bar(experiment.setup.name)));
    }
    console.progress(experiment.setup.name, 1.0);
    save_results(results, folder.path());
    if (console.json) continue;
    const std::string title = experiment.setup.title.empty() ? "" : ": " + experiment.setup.title;
    console.out() << "== " << experiment.setup.name << title << '\n';
    print_table(console.out(), summary_table(results.experiments.back()));
    console.out() << '\n' << std::flush;
  }
  if (const auto sums = total_table(results); !console.json && !sums.empty()) {
    console.out() << "== all experiments\n";
    print_table(console.out(), sums);
    console.out() << '\n' << std::flush;
  }
  finished.remove_file();
}

/// Runs all and lets the results take the place of older ones. An error says what is left.
void run_and_publish(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
                     const CompareOptions& options, CompareResults& results, Console& console) {
  AtomicFolder folder(options.out, is_of_comparison, Unpublished::kept);
  try {
    run_all(suite, prepared, options, folder, results, console);
    folder.publish();
  } catch (const std::exception& error) {
    const std::string left = folder.what_is_left();
    if (left.empty()) throw;
    throw std::runtime_error(std::string(error.what()) + "; " + left);
  }
}

}  // namespace

int run_compare(const CompareOptions& options, Console& console) {
  const Suite suite = chosen_suite(options);
  const std::vector<PreparedExperiment> prepared = prepare_all(suite, options);
  CompareResults results = stamped(suite, options);
  run_and_publish(suite, prepared, options, results, console);

  for (const std::string& sentence : invalid_ends(results)) console.warn("clearway: " + sentence);
  const std::vector<std::string> broken = broken_promises(results);
  for (const std::string& sentence : broken) console.warn("clearway: " + sentence);
  if (console.json) {
    console.out() << to_json(results) << '\n';
  } else {
    console.out() << "  " << (options.out / "report.html").string()
                  << " (beside it results.sqlite, results.csv, results.log, plans)\n";
  }
  return broken.empty() ? exit_done : exit_no;
}

}  // namespace clearway
