// OMPL's benchmark log: what Debian's ompl_benchmark_statistics reads line by line. Names end at a blank
// there, and values at "; ".

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/results/compare_results.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// OMPL's own numbers of its planner statuses.
constexpr std::array ompl_statuses = {"Unknown status",         "Invalid start", "Invalid goal",
                                      "Unrecognized goal type", "Timeout",       "Approximate solution",
                                      "Exact solution",         "Crash",         "Abort"};

int ompl_status(const CompareRun& run) {
  if (run.ended == "hung") return 4;
  if (!run.ended.empty()) return 7;
  switch (run.status) {
    case PlanStatus::solved:
      return 6;
    case PlanStatus::start_invalid:
      return 1;
    case PlanStatus::goal_invalid:
      return 2;
    case PlanStatus::timed_out:
      return 4;
    case PlanStatus::no_path:
      break;
  }
  return 8;
}

std::string one_word(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c <= ' '; }, '_');
  return text;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

constexpr std::array properties = {"time REAL",
                                   "solved BOOLEAN",
                                   "correct solution BOOLEAN",
                                   "status ENUM",
                                   "solution length REAL",
                                   "path cost REAL",
                                   "solution clearance REAL",
                                   "graph states INTEGER",
                                   "valid configurations checked INTEGER",
                                   "graph motions INTEGER",
                                   "problem INTEGER",
                                   "run INTEGER"};

std::string run_line(const CompareRun& run, std::size_t problem) {
  const std::array values = {to_text(run.time),
                             std::to_string(run.is_solved()),
                             run.is_solved() ? std::to_string(run.is_valid()) : std::string(),
                             std::to_string(ompl_status(run)),
                             run.is_solved() ? to_text(run.length) : std::string(),
                             run.is_solved() && !std::isnan(run.cost) ? to_text(run.cost) : std::string(),
                             run.is_valid() ? to_text(run.min_clearance) : std::string(),
                             run.is_solved() ? std::to_string(run.waypoints) : std::string(),
                             std::to_string(run.configurations),
                             std::to_string(run.edges),
                             std::to_string(problem),
                             std::to_string(run.number)};
  static_assert(values.size() == properties.size());
  std::string line;
  for (const std::string& value : values) line += value + "; ";
  return line + "\n";
}

std::string planner_block(const CompareExperiment& experiment, std::size_t planner, const std::string& name) {
  const ComparePlanner& who = experiment.planners[planner];
  std::string text = name + "\n" + std::to_string(who.options.size()) + " common properties\n";
  for (const auto& [key, value] : who.options) text += key + " = " + one_line(value) + "\n";
  text += std::to_string(properties.size()) + " properties for each run\n";
  for (const char* property : properties) text += std::string(property) + "\n";
  std::string lines;
  std::size_t count = 0, number = 0;
  for (const CompareProblem& problem : experiment.problems) {
    ++number;
    for (const CompareRun& run : problem.runs) {
      if (run.planner != planner) continue;
      lines += run_line(run, number);
      ++count;
    }
  }
  return text + std::to_string(count) + " runs\n" + lines + ".\n";
}

double longest_time_limit(const CompareResults& results) {
  double longest = 0.0;
  for (const CompareExperiment& experiment : results.experiments) {
    if (std::isfinite(experiment.time_limit)) longest = std::max(longest, experiment.time_limit);
  }
  return longest;
}

}  // namespace

std::string to_ompl_log(const CompareResults& results) {
  std::string blocks;
  std::size_t planners = 0;
  for (const CompareExperiment& experiment : results.experiments) {
    for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
      const std::string label = one_line(experiment.planners[i].label);
      blocks += planner_block(experiment, i, one_line(experiment.setup.name) + "/" + label);
      ++planners;
    }
  }
  std::string text = "Clearway version " + results.version + "\n";
  text += "Experiment " + one_word(results.suite) + "\n";
  text += "Running on " + one_word(results.host) + "\n";
  text += "Starting at " + results.date + "\n";
  text += "<<<|\n" + one_line(results.title) + " (" + one_line(results.file) + ")\n|>>>\n";
  text += "<<<|\n" + one_line(results.processor) + "\n|>>>\n";
  text += std::to_string(results.seed) + " is the random seed\n";
  text += to_text(longest_time_limit(results)) + " seconds per run\n";
  text += "0 MB per run\n";
  text += to_text(results.time) + " seconds spent to collect the data\n";
  text += "1 enum type\nstatus";
  for (const char* status : ompl_statuses) text += std::string("|") + status;
  return text + "\n" + std::to_string(planners) + " planners\n" + blocks;
}

}  // namespace clearway
