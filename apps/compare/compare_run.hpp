#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/compare/compare_results.hpp"
#include "apps/compare/finished_problems.hpp"
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
};

/// Looks up robot, policies, planners, options and plots of an experiment; `only` keeps the planners with
/// these labels or names (all when empty). Teams have their map loaded or made, and sensors looked for in it.
/// @throws std::invalid_argument, one sentence naming experiment, field and what was expected.
PreparedExperiment prepare(const Suite& suite, const SuiteExperiment& experiment,
                           const std::vector<std::string>& only);

struct CompareChoice {
  std::uint64_t seed = 1;     ///< of the first run of each problem; the next runs have the next seeds
  int jobs = 1;               ///< problems at the same time
  std::filesystem::path out;  ///< folder of results; plans are saved below it, maps with `keep_maps`
  std::filesystem::path shown_out = {};  ///< where it will be: the name of kept maps in results
  bool keep_maps = false;
  FinishedProblems* finished = nullptr;  ///< is told of each problem, where there is one
};

/// Plans every problem with every planner. Each answer's path is judged by the independent check
/// (check_path), whoever planned it. Before the time is taken, a planner is asked for the way from the start
/// to the start, so that what it derives from a map (as our own fields) is not counted. The results do not
/// depend on `jobs`, the times apart.
/// @param progress called from one thread at a time with the share that is done
CompareExperiment run_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                 const CompareChoice& choice, const std::function<void(double)>& progress);

}  // namespace clearway
