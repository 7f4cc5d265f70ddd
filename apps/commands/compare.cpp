#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <ostream>
#include <set>
#include <stdexcept>
#include <thread>

#include "apps/compare/compare_inputs.hpp"
#include "apps/compare/compare_run.hpp"
#include "apps/compare/compare_session.hpp"
#include "apps/console/build_stamp.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "apps/results/compare_diff.hpp"
#include "apps/results/compare_files.hpp"
#include "apps/results/compare_merge.hpp"
#include "apps/suites/suite_resolutions.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// Refuses a chosen name that is not among the known ones.
/// @param hint a sentence more about one that is not
void require_known(const std::string& flag, const std::vector<std::string>& chosen,
                   const std::vector<std::string>& known, const std::string& hint = "") {
  for (const std::string& name : chosen) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw std::invalid_argument(
        flag + ": the suite has no " + quote(name) + ": " +
        (hint.empty() ? suggestion(name, known) : ended(suggestion(name, known)) + " " + hint));
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

fs::path suite_file(const CompareOptions& options) { return shipped_file("suites", options.what.front()); }

Suite chosen_suite(const CompareOptions& options) {
  Suite suite = load_suite(suite_file(options));
  add_chosen_planners(options.planners, suite);
  std::vector<std::string> chosen = options.experiments;
  std::vector<std::string> names;
  for (const SuiteExperiment& experiment : suite.experiments) {
    names.push_back(experiment.name);
    const bool is_chosen = std::find(chosen.begin(), chosen.end(), experiment.name) != chosen.end();
    for (const std::string& name : names_at_resolutions(experiment)) {
      names.push_back(name);
      if (is_chosen) chosen.push_back(name);
    }
  }
  require_known("--experiments", options.experiments, names);
  expand_resolutions(suite);
  if (!chosen.empty()) {
    std::erase_if(suite.experiments, [&](const SuiteExperiment& experiment) {
      return std::find(chosen.begin(), chosen.end(), experiment.name) == chosen.end();
    });
  }
  if (options.time_limit) {
    for (SuiteExperiment& experiment : suite.experiments) experiment.time_limit = options.time_limit;
  }
  if (options.seed) suite.seed = *options.seed;
  return suite;
}

std::vector<ExternalChoice> chosen_externals(const CompareOptions& options) {
  std::vector<ExternalChoice> externals;
  for (const std::string& text : options.externals) {
    const std::size_t equals = text.find('=');
    externals.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return externals;
}

/// What one should know of an experiment's robot and problems.
std::vector<std::string> notes_on(const Suite& suite, const PreparedExperiment& experiment) {
  std::vector<std::string> notes = robot_notes(experiment.robot, experiment.setup.packages);
  if (const std::string missing = missing_masses(experiment.robot, experiment.setup.gravity);
      !missing.empty())
    notes.push_back(missing + ", so costs of robot " + quote(experiment.setup.robot) + " are not known");
  const std::vector<std::string> more = SuiteStages(suite, experiment.setup, experiment.robot).notes();
  notes.insert(notes.end(), more.begin(), more.end());
  return notes;
}

/// Every name of every experiment is looked up before anything runs.
std::vector<PreparedExperiment> prepare_all(const Suite& suite, const CompareOptions& options) {
  std::set<std::string> planners;
  std::vector<PreparedExperiment> prepared;
  const std::vector<ExternalChoice> externals = chosen_externals(options);
  for (const ExternalChoice& external : externals) planners.insert(external.label);
  for (const SuiteExperiment& experiment : suite.experiments) {
    for (const SuitePlanner& planner : experiment.planners) {
      planners.insert(planner.label);
      planners.insert(planner.planner);
    }
    prepared.push_back(prepare(suite, experiment, options.planners, externals));
  }
  require_known("--planners", options.planners, {planners.begin(), planners.end()});
  std::erase_if(prepared, [](const PreparedExperiment& experiment) { return experiment.planners.empty(); });
  for (PreparedExperiment& experiment : prepared) {  // worlds, generators, numbers of joints
    if (!experiment.setup.teams) experiment.notes = notes_on(suite, experiment);
    for (const SuiteWorld& world : suite.worlds)
      if (experiment.map && world.name == experiment.setup.world)
        if (std::string note = note_on_cloud(world, *experiment.map); !note.empty())
          experiment.notes.push_back(std::move(note));
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
  results.file = options.what.front().string();
  if (options.seed) results.flags += " --seed " + std::to_string(*options.seed);
  if (options.time_limit) results.flags += " --time-limit " + short_text(*options.time_limit);
  if (options.shards > 1)
    results.part = "part " + std::to_string(options.shard) + " of " + std::to_string(options.shards);
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

CompareChoice choice_of(const Suite& suite, const CompareOptions& options, const fs::path& folder) {
  return {.seed = suite.seed,
          .jobs = options.jobs,
          .out = folder,
          .keep_maps = options.keep_maps,
          .isolation = {options.isolate, options.grace, 1e9 * options.memory},
          .shard = {options.shard, options.shards},
          .worst_pages = options.worst_pages};
}

/// Runs all and lets the results take the place of older ones. An error says what is left.
CompareResults run_and_publish(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
                               const CompareOptions& options, CompareAsked asked, Console& console) {
  if (options.resume) {
    const CompareChoice choice = choice_of(suite, options, options.out);
    const auto runs = [&](const CompareRecords& records) {
      std::size_t all = 0;
      for (std::size_t e = 0; e < prepared.size(); ++e)
        all += count_runs(suite, prepared[e], e, choice, &records);
      return all;
    };
    if (auto finished = finished_results(options.out, asked, runs)) {
      console.log("clearway: " + quote(options.out.string()) + " is finished: nothing was left to run");
      if (!console.json) print_results(*finished, console);
      return std::move(*finished);
    }
  }
  if (!options.resume) require_nothing_unfinished(options.out);
  AtomicFolder folder(options.out, is_of_comparison,
                      options.resume ? Unpublished::continued : Unpublished::kept);
  try {
    const CompareChoice choice = choice_of(suite, options, folder.path());
    CompareResults results =
        CompareSession(folder, std::move(asked), options.resume).run(suite, prepared, choice, console);
    folder.publish();
    return results;
  } catch (const std::runtime_error& error) {
    const std::string left = folder.unfinished_work();
    if (left.empty()) throw;
    throw std::runtime_error(std::string(error.what()) + "; " + left);
  }
}

void report_warnings(const CompareResults& results, Console& console) {
  for (const auto& sentences :
       {invalid_ends(results), runs_without_answer(results), broken_promises(results)})
    for (const std::string& sentence : sentences) console.warn("clearway: " + sentence);
  for (const std::string& note : results.notes) console.warn("note: " + note);
  if (!results.part.empty())
    console.warn("note: this is " + results.part + "; `clearway compare merge` makes one of all parts");
}

CompareAsked asked_of(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
                      const CompareOptions& options) {
  CompareAsked asked{stamped(suite, options),
                     sha256(read_input(suite_file(options), "suite", SIZE_MAX)),
                     {options.shard, options.shards}};
  std::vector<const SuiteExperiment*> setups;
  for (const PreparedExperiment& experiment : prepared) setups.push_back(&experiment.setup);
  asked.results.map_sha256 = map_digests(suite, setups);
  std::vector<std::string>& notes = asked.results.notes;
  for (const PreparedExperiment& experiment : prepared) {
    asked.results.experiments.push_back(asked_of(experiment));
    for (const std::string& note : experiment.notes)  // once for each map
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
  return asked;
}

/// Refuses a place where maps of results would take that of a map that the suite reads.
void require_apart_from(const SuiteWorld& world, const fs::path& out) {
  const std::string name = "world " + quote(world.name) + " of the suite";
  require_apart({{"--out", out}}, {{name, world.map}});
  std::error_code error;
  if (world.map.empty() || !fs::exists(world.map, error)) return;
  const fs::path map = fs::is_directory(world.map, error) ? world.map / "map.ot" : world.map;
  const fs::path below =
      fs::weakly_canonical(map, error).lexically_relative(fs::weakly_canonical(out, error));
  if (below.empty() || *below.begin() == ".." || !is_of_comparison(below)) return;
  throw std::invalid_argument("--out: " + quote_path(out.string()) + " holds " +
                              quote_path(world.map.string()) + ", the map of " + name +
                              ", where results have theirs, expected another place " + "to write to");
}

int run_suite(const CompareOptions& options, Console& console) {
  const Suite suite = chosen_suite(options);
  for (const SuiteWorld& world : suite.worlds) require_apart_from(world, options.out);
  const std::vector<PreparedExperiment> prepared = prepare_all(suite, options);
  const CompareResults results =
      run_and_publish(suite, prepared, options, asked_of(suite, prepared, options), console);
  report_warnings(results, console);
  if (console.json) {
    console.out() << to_json(results) << '\n';
  } else {
    console.out() << "  " << (options.out / "report.html").string()
                  << " (beside it results.sqlite, results.csv, results.log, plans)\n";
  }
  return broken_promises(results).empty() ? exit_done : exit_no;
}

/// The parts of an id as printed.
struct RunId {
  std::string experiment, problem, planner;
};

RunId parse_id(const std::string& text) {
  const std::size_t first = text.find('/'), last = text.rfind('/');
  if (first == std::string::npos || first == last || text.find('/', first + 1) != last)
    throw std::invalid_argument("--rerun: expected EXPERIMENT/PROBLEM/PLANNER[-RUN] as printed, got '" +
                                text + "'");
  return {text.substr(0, first), text.substr(first + 1, last - first - 1), text.substr(last + 1)};
}

void choose_experiment(const std::string& name, Suite& suite) {
  std::vector<std::string> known;
  for (const SuiteExperiment& experiment : suite.experiments) known.push_back(name_as_file(experiment.name));
  require_known("--rerun", {name}, known);
  std::erase_if(suite.experiments,
                [&](const SuiteExperiment& experiment) { return name_as_file(experiment.name) != name; });
}

/// The planner of that name, with or without the number of a run, where the experiment does not list it:
/// `--planners` had named it.
void add_printed_planner(const std::string& name, Suite& suite) {
  const std::string without_number = name.substr(0, name.find_last_not_of("0123456789") + 1);
  for (const PlannerEntry& planner : planner_table()) {
    const std::string label = name_as_file(std::string(planner.name));
    if (label == name || label + "-" == without_number)
      add_chosen_planners({std::string(planner.name)}, suite);
  }
}

/// Leaves the planner of that name alone. Returns the number of the run. @param hint see require_known
int choose_planner(const std::string& name, const std::string& hint, PreparedExperiment& experiment) {
  std::vector<std::string> known;
  const std::vector<std::string> planners = names_as_files(experiment.planners);
  const int runs = experiment.setup.runs;
  for (std::size_t p = 0; p < planners.size(); ++p) {
    for (int number = 1; number <= runs; ++number) {
      known.push_back(planners[p] + (runs > 1 ? "-" + std::to_string(number) : ""));
      if (known.back() != name) continue;
      experiment.planners = {experiment.planners[p]};
      if (!experiment.makers.empty()) experiment.makers = {experiment.makers[p]};
      if (!experiment.leaders.empty()) experiment.leaders = {experiment.leaders[p]};
      return number;
    }
  }
  require_known("--rerun", {name}, known, hint);
  return 1;
}

void print_run(const CompareExperiment& experiment, const std::string& id, Console& console) {
  const CompareProblem& problem = experiment.problems.front();
  const CompareRun& run = problem.runs.front();
  print_rows(console.out(), {{"run", id},
                             {"seed", std::to_string(run.seed)},
                             {"outcome", run.outcome()},
                             {"check", run.contact.empty() ? run.check : run.check + ": " + run.contact},
                             {"explanation", run.explanation.empty() ? "-" : run.explanation},
                             {"time", significant(run.time) + " s" +
                                          (run.team ? "" : ", CPU " + significant(run.cpu) + " s")}});
}

/// Names the near ones of the problems of all stages, which were opened in the search for it, or says why
/// there is none.
[[noreturn]] void refuse_problem(const RunId& id, const CompareRecords& records) {
  records.require_problems();
  std::vector<std::string> known;
  for (const auto& [experiment, stage] : records.stages())
    for (const CompareRecords::Problem& problem : *records.stage(experiment, stage))
      known.push_back(name_as_file(problem.found.name));
  constexpr std::size_t most_named = 20;
  std::string near = nearest_name(id.problem, known).empty() && known.size() > most_named
                         ? std::to_string(known.size()) + " others, such as " +
                               listed({known.begin(), known.begin() + most_named})
                         : suggestion(id.problem, known);
  throw std::invalid_argument("--rerun: experiment '" + id.experiment + "' has no problem '" + id.problem +
                              "': " + near);
}

int rerun(const CompareOptions& options, Console& console) {
  const RunId id = parse_id(options.rerun);
  if (fs::exists(options.out))
    throw std::invalid_argument("--rerun: '" + options.out.string() +
                                "' exists: expected a new folder for --out, or none");
  Suite suite = chosen_suite(options);
  choose_experiment(id.experiment, suite);
  add_printed_planner(id.planner, suite);
  suite.experiments.front().plots = {"animation"};
  std::vector<PreparedExperiment> prepared = prepare_all(suite, options);
  const std::string hint =
      options.externals.empty() ? "An external planner needs its --external NAME=COMMAND here, too." : "";
  const int number = choose_planner(id.planner, hint, prepared.front());
  const CompareAsked asked = asked_of(suite, prepared, options);
  const fs::path beside = fs::temp_directory_path() / ("clearway-rerun-" + std::to_string(::getpid()));
  AtomicFolder folder(options.out.empty() ? beside : options.out, is_of_comparison);
  CompareChoice choice = choice_of(suite, options, folder.path());
  choice.only = CompareOnly{id.problem, number};
  CompareRecords records(asked);
  run_experiment(suite, prepared.front(), 0, choice, records, [](std::size_t, std::size_t) {});
  const CompareResults results = records.results(folder.path());
  if (results.experiments.front().problems.empty()) refuse_problem(id, records);
  if (!options.out.empty()) {
    save_results(results, folder.path());
    folder.publish();
  }
  if (console.json) {
    console.out() << to_json(results) << '\n';
  } else {
    print_run(results.experiments.front(), options.rerun, console);
  }
  return results.experiments.front().problems.front().runs.front().is_valid() ? exit_done : exit_no;
}

int merge(const CompareOptions& options, Console& console) {
  for (auto shard = options.what.begin() + 1; shard != options.what.end(); ++shard)
    require_apart({{"--out", options.out}}, {{"compare merge", *shard}});
  AtomicFolder folder(options.out, is_of_comparison);
  const CompareResults results = merge_into(folder.path(), {options.what.begin() + 1, options.what.end()});
  folder.publish();
  report_warnings(results, console);
  print_results(results, console);
  return broken_promises(results).empty() ? exit_done : exit_no;
}

int report_difference(const CompareOptions& options, Console& console) {
  if (options.what.size() != 3)
    throw std::invalid_argument("compare diff: got " + std::to_string(options.what.size() - 1) +
                                " results: expected two, OLD and NEW");
  const CompareDiff diff = compare_diff(options.what[1], options.what[2]);
  if (console.json) {
    console.out() << to_json(diff) << '\n';
  } else {
    print_table(console.out(), diff_table(diff));
    for (const std::string& note : diff.notes) console.out() << note << '\n';
    console.out() << diff.verdict() << '\n';
  }
  return diff.is_worse() ? exit_no : exit_done;
}

void require_flags(const CompareOptions& options, bool merges) {
  if (options.what.size() > 1 && !merges)
    throw std::invalid_argument("compare: got " + std::to_string(options.what.size()) +
                                " files: expected one suite, or `merge DIR…`, or `diff OLD NEW`");
  if (options.out.empty() && options.rerun.empty())
    throw std::invalid_argument("compare: --out is required (see clearway compare --help)");
  if (!options.isolate && options.jobs > 1)
    throw std::invalid_argument("--isolate no: expected --jobs 1, because all is done in one process, got " +
                                std::to_string(options.jobs));
}

}  // namespace

int run_compare(const CompareOptions& options, Console& console) {
  const std::string kind = options.what.front().string();
  if (kind == "diff") return report_difference(options, console);
  require_flags(options, kind == "merge");
  if (kind == "merge") return merge(options, console);
  return options.rerun.empty() ? run_suite(options, console) : rerun(options, console);
}

}  // namespace clearway
