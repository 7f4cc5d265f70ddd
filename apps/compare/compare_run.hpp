#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/results/compare_records.hpp"
#include "apps/results/compare_results.hpp"
#include "apps/suites/suite_stages.hpp"
#include "planning/team/team.hpp"

namespace clearway {

/// An experiment whose every name was looked up: it can be run.
struct PreparedExperiment {
  SuiteExperiment setup;
  Robot robot;
  Policies policies;
  double time_limit = 0.0;  ///< s of wall clock: a leg; a run of a team, infinity: none
  std::vector<ComparePlanner> planners;
  std::vector<std::shared_ptr<const Planner>> makers;  ///< of these; none for teams
  std::vector<TeamOptions> leaders;                    ///< of these, for teams
  std::optional<Snapshot> map;                         ///< for teams: of their world
  std::vector<std::string> notes = {};                 ///< what a reader should know of its maps
};

/// A planner in another process, in every experiment but those of teams (external_planner.hpp).
struct ExternalChoice {
  std::string label, command;
};

/// Looks up robot, policies, planners, options and plots of an experiment; `only` keeps the planners with
/// these labels or names (all when empty). Teams have their map loaded or made, and sensors looked for in it.
/// @throws std::invalid_argument, one sentence naming experiment, field and what was expected.
PreparedExperiment prepare(const Suite& suite, const SuiteExperiment& experiment,
                           const std::vector<std::string>& only,
                           const std::vector<ExternalChoice>& externals = {});

/// How far a run is kept from all others.
struct CompareIsolation {
  bool is_on = true;    ///< a process each; else all in this one, for debugging
  double grace = 60.0;  ///< s of wall clock beyond the time limit, for preparation and check
  double memory = 8e9;  ///< bytes of address space beyond what the program holds
};

/// The one run of `--rerun`.
struct CompareOnly {
  std::string problem;  ///< its name as a file's
  int number = 1;       ///< of its runs
};

struct CompareChoice {
  std::uint64_t seed = 1;     ///< of the first run of each problem; the next runs have the next seeds
  int jobs = 1;               ///< problems at the same time
  std::filesystem::path out;  ///< folder of results; plans are saved below it, maps with `keep_maps`
  bool keep_maps = false;
  CompareIsolation isolation = {};
  CompareShard shard = {};
  std::optional<CompareOnly> only = {};
  int worst_pages = 0;  ///< pages in 3D of the worst runs, at most, each experiment (worst_case_pages.hpp)
};

/// Called with how many runs of an experiment are done, of how many; and, with the same, as time goes by.
using CompareProgress = std::function<void(std::size_t done, std::size_t all)>;

/// How many runs an experiment has for this choice, at most; without those of stages in which, as `records`
/// know, no problem was found.
std::size_t count_runs(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                       const CompareChoice& choice, const CompareRecords* records = nullptr);

/// Plans every problem with every planner, but for the runs that `records` have. Each answer's path is judged
/// by the independent check (check_path), whoever planned it. Before the time is taken, a planner is asked
/// for the way from the start to the start, so that what it derives from a map (as our own fields) is not
/// counted. What is found does not depend on `jobs` and `isolation`, the times apart.
///
/// Each run has a process of its own (problem_server.hpp). To be called while no other thread runs but one
/// that waits for signals: workers are forked from this one.
/// @param index of the experiment in `records`
/// A generator that finds no problem in a world leaves that world without runs, and `records` with the
/// reason.
/// @throws std::invalid_argument, DamagedFile or std::runtime_error when a world cannot be loaded or made, a
/// planner refuses a robot, or a file cannot be written.
void run_experiment(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                    const CompareChoice& choice, CompareRecords& records, const CompareProgress& progress);

/// The same of one experiment, into memory and files below `choice.out`.
CompareExperiment run_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                 const CompareChoice& choice);

/// An experiment as asked, without problems.
CompareExperiment asked_of(const PreparedExperiment& experiment);

}  // namespace clearway
