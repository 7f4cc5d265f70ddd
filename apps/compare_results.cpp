#include "apps/compare_results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/parse.hpp"
#include "planning/option_reader.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

/// Nearest rank; NaN for none.
double quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(p * static_cast<double>(values.size()));
  return values[std::min(static_cast<std::size_t>(std::max(rank, 1.0)) - 1, values.size() - 1)];
}

std::string cell(double value, int digits = 3) {
  return std::isfinite(value) ? significant(value, digits) : "-";
}

std::string unsolved_text(const CompareSummary& sum) {
  std::string text;
  for (const auto& [status, count] : sum.unsolved) {
    text += (text.empty() ? "" : ", ") + status + " " + std::to_string(count);
  }
  return text.empty() ? "-" : text;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_row(const std::vector<std::string>& fields) {
  std::string row;
  for (const std::string& field : fields) row += csv_field(field) + ",";
  row.back() = '\n';
  return row;
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json summary_json(const CompareExperiment& experiment, std::size_t planner) {
  const ComparePlanner& who = experiment.planners[planner];
  const CompareSummary sum = summary(experiment, planner);
  return {{"label", who.label},
          {"planner", who.planner},
          {"options", who.options},
          {"certified", who.certified},
          {"solved", sum.solved},
          {"valid", sum.valid},
          {"total", sum.total},
          {"time_median_s", number_or_null(sum.time_median)},
          {"time_p95_s", number_or_null(sum.time_p95)},
          {"cost_median_joules", number_or_null(sum.cost_median)},
          {"length_median_rad", number_or_null(sum.length_median)},
          {"steps_median", number_or_null(sum.steps_median)},
          {"safe", sum.safe},
          {"outrun", sum.outrun},
          {"refused", sum.refused},
          {"unsolved", sum.unsolved}};
}

}  // namespace

CompareSummary summary(const CompareExperiment& experiment, std::size_t planner) {
  CompareSummary sum;
  std::vector<double> times, costs, lengths, steps, motions;
  for (const CompareProblem& problem : experiment.problems) {
    for (const CompareRun& run : problem.runs) {
      if (run.planner != planner) continue;
      ++sum.total;
      sum.safe += run.check == "valid";
      sum.outrun += run.check == "outrun";
      sum.refused += run.check == "refused";
      if (run.team && run.check != "outrun" && run.check != "none") {
        const double shortfall = run.team->security_distance - run.min_clearance;
        sum.worst_shortfall = std::max(sum.worst_shortfall, shortfall);
        sum.allowed_shortfall = std::max(sum.allowed_shortfall, run.team->step_bound);
      }
      if (!run.is_solved()) {
        ++sum.unsolved[std::string(to_string(run.status))];
        continue;
      }
      ++sum.solved;
      times.push_back(run.time);
      if (!run.is_valid()) continue;
      ++sum.valid;
      if (run.team) motions.push_back(run.team->motion_time);
      costs.push_back(run.cost);
      lengths.push_back(run.length);
      steps.push_back(static_cast<double>(run.steps));
    }
  }
  sum.time_median = quantile(times, 0.5);
  sum.time_p95 = quantile(times, 0.95);
  sum.cost_median = quantile(costs, 0.5);
  sum.length_median = quantile(lengths, 0.5);
  sum.steps_median = quantile(steps, 0.5);
  sum.motion_median = quantile(motions, 0.5);
  return sum;
}

std::vector<std::string> broken_promises(const CompareResults& results) {
  std::vector<std::string> sentences;
  for (const CompareExperiment& experiment : results.experiments) {
    for (const CompareProblem& problem : experiment.problems) {
      for (const CompareRun& run : problem.runs) {
        const ComparePlanner& who = experiment.planners[run.planner];
        if (!who.certified || (run.check != "refused" && run.check != "undecided")) continue;
        sentences.push_back("experiment '" + experiment.setup.name + "', problem '" + problem.name + "': '" +
                            who.label + "' promises certified paths and returned one that the check holds " +
                            run.check + " (" + run.contact + ")");
      }
    }
  }
  return sentences;
}

namespace {

std::vector<std::vector<std::string>> team_table(const CompareExperiment& experiment) {
  std::vector<std::vector<std::string>> rows{{"planner", "arrived / valid / total", "safe", "outrun",
                                              "refused", "motion s", "below d_s mm", "allowed mm",
                                              "computed in s", "not arrived"}};
  for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
    const CompareSummary sum = summary(experiment, i);
    rows.push_back(
        {experiment.planners[i].label,
         std::to_string(sum.solved) + " / " + std::to_string(sum.valid) + " / " + std::to_string(sum.total),
         std::to_string(sum.safe), std::to_string(sum.outrun), std::to_string(sum.refused),
         cell(sum.motion_median), cell(1000.0 * sum.worst_shortfall), cell(1000.0 * sum.allowed_shortfall),
         cell(sum.time_median), unsolved_text(sum)});
  }
  return rows;
}

}  // namespace

std::vector<std::vector<std::string>> summary_table(const CompareExperiment& experiment) {
  if (experiment.setup.teams) return team_table(experiment);
  std::vector<std::vector<std::string>> rows{{"planner", "solved / valid / total", "median s", "p95 s",
                                              "cost J", "length rad", "steps", "unsolved"}};
  for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
    const CompareSummary sum = summary(experiment, i);
    rows.push_back(
        {experiment.planners[i].label,
         std::to_string(sum.solved) + " / " + std::to_string(sum.valid) + " / " + std::to_string(sum.total),
         cell(sum.time_median), cell(sum.time_p95), cell(sum.cost_median, 4), cell(sum.length_median, 4),
         cell(sum.steps_median, 6), unsolved_text(sum)});
  }
  return rows;
}

std::string to_csv(const CompareResults& results) {
  std::string text =
      csv_row({"suite",     "experiment",      "world",          "problem",     "run",        "seed",
               "label",     "planner",         "options",        "certified",   "status",     "solved",
               "valid",     "check",           "legs",           "cost_joules", "length_rad", "steps",
               "waypoints", "min_clearance_m", "configurations", "edges",       "time_s",     "plan",
               "contact",   "explanation"});
  for (const CompareExperiment& experiment : results.experiments) {
    for (const CompareProblem& problem : experiment.problems) {
      for (const CompareRun& run : problem.runs) {
        const ComparePlanner& who = experiment.planners[run.planner];
        text += csv_row({results.suite,
                         experiment.setup.name,
                         problem.world,
                         problem.name,
                         std::to_string(run.number),
                         std::to_string(run.seed),
                         who.label,
                         who.planner,
                         Json(who.options).dump(),
                         std::to_string(who.certified),
                         std::string(to_string(run.status)),
                         std::to_string(run.is_solved()),
                         std::to_string(run.is_valid()),
                         run.check,
                         std::to_string(run.legs),
                         to_text(run.cost),
                         to_text(run.length),
                         std::to_string(run.steps),
                         std::to_string(run.waypoints),
                         to_text(run.min_clearance),
                         std::to_string(run.configurations),
                         std::to_string(run.edges),
                         to_text(run.time),
                         run.plan_file,
                         run.contact,
                         run.explanation});
      }
    }
  }
  return text;
}

std::string to_json(const CompareResults& results) {
  Json json = {{"suite", results.suite},
               {"title", results.title},
               {"file", results.file},
               {"seed", results.seed},
               {"jobs", results.jobs},
               {"version", results.version},
               {"commit", results.commit},
               {"host", results.host},
               {"processor", results.processor},
               {"date", results.date},
               {"time_s", results.time},
               {"experiments", Json::array()},
               {"broken_promises", broken_promises(results)}};
  for (const CompareExperiment& experiment : results.experiments) {
    Json planners = Json::array();
    for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
      planners.push_back(summary_json(experiment, i));
    }
    json["experiments"].push_back({{"name", experiment.setup.name},
                                   {"title", experiment.setup.title},
                                   {"problems", experiment.problems.size()},
                                   {"runs", experiment.setup.runs},
                                   {"time_limit_s", experiment.time_limit},
                                   {"planners", planners}});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway
