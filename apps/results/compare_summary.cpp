#include "apps/results/compare_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "apps/console/number_or_null.hpp"
#include "apps/console/quantile.hpp"
#include "apps/results/compare_statistics.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

/// Counts the problems, and what their runs are worth together.
void count_problems(const std::vector<std::vector<const CompareRun*>>& problems, CompareSummary& sum) {
  std::vector<ProblemRuns> counts;
  for (const auto& runs : problems) {
    const auto valid =
        std::count_if(runs.begin(), runs.end(), [](const auto* run) { return run->is_valid(); });
    counts.push_back({static_cast<std::size_t>(valid), runs.size()});
    sum.problems += !runs.empty();
  }
  sum.effective_runs = effective_runs(counts);
}

/// Of values that add up to more of them: their mean, NaN of none.
double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of runs whose time was split; one that did not come to some work spent 0 s on it.
WorkTimes work_mean(const std::vector<WorkTimes>& runs) {
  WorkTimes sum;
  for (const WorkTimes& run : runs) sum = sum + run;
  for (std::optional<double>* part : {&sum.search, &sum.shortcuts, &sum.proofs})
    if (*part) **part /= static_cast<double>(runs.size());
  return sum;
}

}  // namespace

CompareSummary summary_of(const std::vector<std::vector<const CompareRun*>>& problems) {
  CompareSummary sum;
  count_problems(problems, sum);
  std::vector<const CompareRun*> all;
  for (const auto& runs : problems) all.insert(all.end(), runs.begin(), runs.end());
  std::vector<double> times, cpus, spaces, checks, costs, lengths, steps, motions, motion_cpus;
  std::vector<WorkTimes> works;
  for (const CompareRun* each : all) {
    const CompareRun& run = *each;
    ++sum.total;
    sum.safe += run.check == "valid";
    sum.outrun += run.check == "outrun";
    sum.refused += run.check == "refused";
    if (run.team && run.check != "outrun" && run.check != "none") {
      sum.least_separation = std::fmin(sum.least_separation, run.min_clearance);
      const double shortfall = run.team->security_distance - run.min_clearance;
      sum.worst_shortfall = std::max(sum.worst_shortfall, shortfall);
      sum.allowed_shortfall = std::max(sum.allowed_shortfall, run.team->step_bound);
      if (run.motion) sum.top_acceleration = std::fmax(sum.top_acceleration, run.motion->acceleration);
    }
    if (!run.is_solved()) {
      ++sum.unsolved[run.outcome()];
      continue;
    }
    ++sum.solved;
    times.push_back(run.time);
    cpus.push_back(run.cpu);
    if (run.work.search) works.push_back(run.work);
    spaces.push_back(run.space_cpu + run.derive_cpu);
    checks.push_back(run.check_cpu);
    if (!run.is_valid()) continue;
    ++sum.valid;
    if (run.motion) motions.push_back(run.motion->time);
    if (run.motion) motion_cpus.push_back(run.motion_cpu);
    sum.edge_by_edge += run.motion && !run.motion->note.empty();
    if (!std::isnan(run.cost)) costs.push_back(run.cost);
    lengths.push_back(run.length);
    steps.push_back(static_cast<double>(run.steps));
  }
  sum.time_median = quantile(times, 0.5);
  sum.time_p95 = quantile(times, 0.95);
  sum.cpu_median = quantile(cpus, 0.5);
  sum.check_median = quantile(checks, 0.5);
  sum.work_mean = work_mean(works);
  sum.space_mean = mean(spaces);
  sum.check_mean = mean(checks);
  sum.cost_median = quantile(costs, 0.5);
  sum.length_median = quantile(lengths, 0.5);
  sum.steps_median = quantile(steps, 0.5);
  sum.motion_median = quantile(motions, 0.5);
  sum.motion_cpu_median = quantile(motion_cpus, 0.5);
  return sum;
}

CompareSummary summary(const CompareExperiment& experiment, std::size_t planner) {
  std::vector<std::vector<const CompareRun*>> problems;
  for (const CompareProblem& problem : experiment.problems) {
    auto& runs = problems.emplace_back();
    for (const CompareRun& run : problem.runs)
      if (run.planner == planner) runs.push_back(&run);
  }
  return summary_of(problems);
}

namespace {

Json summary_json(const ComparePlanner& who, const CompareSummary& sum, bool is_of_teams) {
  const double share = sum.total > 0 ? static_cast<double>(sum.valid) / static_cast<double>(sum.total) : 0.0;
  const auto interval = wilson_interval(share, sum.effective_runs);
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  const auto of_teams = [&](const Json& value) { return is_of_teams ? value : Json(nullptr); };
  const auto of_planners = [&](const Json& value) { return is_of_teams ? Json(nullptr) : value; };
  return {{"label", who.label},
          {"planner", who.planner},
          {"options", who.options},
          {"certified", who.certified},
          {"solved", sum.solved},
          {"valid", sum.valid},
          {"total", sum.total},
          {"problems", sum.problems},
          {"effective_runs", sum.effective_runs},
          {"valid_share_95", {interval.first, interval.second}},
          {"refused", sum.refused},
          {"time_median_s", number_or_null(sum.time_median)},
          {"time_p95_s", number_or_null(sum.time_p95)},
          {"cpu_median_s", of_planners(number_or_null(sum.cpu_median))},
          {"check_cpu_median_s", of_planners(number_or_null(sum.check_median))},
          {"space_cpu_mean_s", of_planners(number_or_null(sum.space_mean))},
          {"search_cpu_mean_s", or_null(sum.work_mean.search)},
          {"shortcut_cpu_mean_s", or_null(sum.work_mean.shortcuts)},
          {"proof_cpu_mean_s", or_null(sum.work_mean.proofs)},
          {"check_cpu_mean_s", of_planners(number_or_null(sum.check_mean))},
          {"cost_median_joules", number_or_null(sum.cost_median)},
          {"length_median_rad", number_or_null(sum.length_median)},
          {"steps_median", number_or_null(sum.steps_median)},
          {"motion_time_median_s", number_or_null(sum.motion_median)},
          {"motion_cpu_median_s", of_planners(number_or_null(sum.motion_cpu_median))},
          {"edge_by_edge", of_planners(sum.edge_by_edge)},
          {"safe", of_teams(sum.safe)},
          {"outrun", of_teams(sum.outrun)},
          {"least_separation_m", of_teams(number_or_null(sum.least_separation))},
          {"below_security_distance_m", of_teams(sum.worst_shortfall)},
          {"allowed_below_m", of_teams(sum.allowed_shortfall)},
          {"top_acceleration_share", of_teams(number_or_null(sum.top_acceleration))},
          {"unsolved", sum.unsolved}};
}

}  // namespace

Json summary_json(const ComparePlanner& who, const CompareSummary& sum) {
  return summary_json(who, sum, false);
}

Json summary_json(const CompareExperiment& experiment, std::size_t planner) {
  return summary_json(experiment.planners[planner], summary(experiment, planner),
                      experiment.setup.teams.has_value());
}

}  // namespace clearway
