#include "apps/results/compare_resolutions.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/console/parse.hpp"
#include "apps/results/compare_statistics.hpp"
#include "apps/results/compare_summary.hpp"

namespace clearway {
namespace {

/// Start and goals, joint by joint.
std::vector<double> ways_of(const CompareProblem& problem) {
  std::vector<double> values(problem.start.begin(), problem.start.end());
  for (const Configuration& goal : problem.goals) values.insert(values.end(), goal.begin(), goal.end());
  return values;
}

void count_problems(const CompareResults& results, ResolutionSweep& sweep) {
  std::map<std::vector<double>, std::set<std::size_t>> ways;
  for (const std::size_t e : sweep.experiments) {
    const auto& problems = results.experiments[e].problems;
    sweep.most_problems = std::max(sweep.most_problems, problems.size());
    for (const CompareProblem& problem : problems) ways[ways_of(problem)].insert(e);
  }
  for (const auto& [way, experiments] : ways)
    sweep.same_problems += experiments.size() == sweep.experiments.size();
}

double resolution_of(const CompareExperiment& experiment) { return experiment.problems.front().resolution; }

ResolutionSweep sweep_of(const CompareResults& results, std::vector<std::size_t> experiments) {
  std::stable_sort(experiments.begin(), experiments.end(), [&](std::size_t a, std::size_t b) {
    return resolution_of(results.experiments[a]) < resolution_of(results.experiments[b]);
  });
  ResolutionSweep sweep;
  sweep.experiments = experiments;
  for (const std::size_t e : experiments) sweep.resolutions.push_back(resolution_of(results.experiments[e]));
  for (std::size_t p = 0; p < results.experiments[experiments.front()].planners.size(); ++p) {
    ResolutionRow& row = sweep.planners.emplace_back();
    row.planner = p;
    for (const std::size_t e : experiments) row.points.push_back(summary(results.experiments[e], p));
  }
  count_problems(results, sweep);
  return sweep;
}

}  // namespace

std::vector<ResolutionSweep> resolution_sweeps(const CompareResults& results) {
  std::vector<std::string> names;  // in the order of the suite
  std::map<std::string, std::vector<std::size_t>> alike;
  for (std::size_t e = 0; e < results.experiments.size(); ++e) {
    const CompareExperiment& experiment = results.experiments[e];
    if (experiment.setup.alike.empty() || experiment.problems.empty()) continue;
    if (alike[experiment.setup.alike].empty()) names.push_back(experiment.setup.alike);
    alike[experiment.setup.alike].push_back(e);
  }
  std::vector<ResolutionSweep> sweeps;
  for (const std::string& name : names)
    if (alike[name].size() > 1) sweeps.push_back(sweep_of(results, alike[name]));
  return sweeps;
}

std::string sweep_name(const CompareResults& results, const ResolutionSweep& sweep) {
  std::string names;
  for (const std::size_t e : sweep.experiments)
    names += (names.empty() ? "" : ", ") + results.experiments[e].setup.name;
  return names;
}

std::string sweep_note(const ResolutionSweep& sweep) {
  if (sweep.same_problems == sweep.most_problems) return "The same problems at all resolutions.";
  return "Of " + counted(sweep.most_problems, "problem") + " " + std::to_string(sweep.same_problems) +
         " have the same start and goals at all resolutions; the others were drawn anew, because the map at "
         "that resolution decides which draws are kept.";
}

std::vector<std::vector<std::string>> sweep_table(const CompareResults& results,
                                                  const ResolutionSweep& sweep) {
  std::vector<std::vector<std::string>> rows{
      {"planner", "voxels mm", "solved / valid / total", "valid % (95 %)", "median s", "p95 s", "CPU s"}};
  for (const ResolutionRow& row : sweep.planners)
    for (std::size_t i = 0; i < row.points.size(); ++i) {
      const CompareSummary& sum = row.points[i];
      rows.push_back({results.experiments[sweep.experiments[i]].planners[row.planner].label,
                      significant(1000.0 * sweep.resolutions[i]), counts_text(sum), success_text(sum),
                      cell_text(sum.time_median), cell_text(sum.time_p95), cell_text(sum.cpu_median)});
    }
  return rows;
}

nlohmann::ordered_json sweeps_json(const CompareResults& results) {
  auto sweeps = nlohmann::ordered_json::array();
  for (const ResolutionSweep& sweep : resolution_sweeps(results)) {
    auto planners = nlohmann::ordered_json::array();
    auto experiments = nlohmann::ordered_json::array();
    for (const std::size_t e : sweep.experiments) experiments.push_back(results.experiments[e].setup.name);
    for (const ResolutionRow& row : sweep.planners) {
      const ComparePlanner& who = results.experiments[sweep.experiments.front()].planners[row.planner];
      auto points = nlohmann::ordered_json::array();
      for (const CompareSummary& sum : row.points) points.push_back(summary_json(who, sum));
      planners.push_back({{"label", who.label}, {"points", points}});
    }
    sweeps.push_back({{"experiments", experiments},
                      {"resolutions_m", sweep.resolutions},
                      {"same_problems", sweep.same_problems},
                      {"note", sweep_note(sweep)},
                      {"planners", planners}});
  }
  return sweeps;
}

}  // namespace clearway
