#include "apps/results/compare_results.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/console/number_or_null.hpp"
#include "apps/console/parse.hpp"
#include "apps/results/compare_columns.hpp"
#include "apps/results/compare_overview.hpp"
#include "apps/results/compare_record.hpp"
#include "apps/results/compare_resolutions.hpp"
#include "apps/results/compare_statistics.hpp"
#include "apps/results/compare_summary.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

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

std::string csv_text(const CompareCell& cell) {
  if (const auto* whole = std::get_if<std::int64_t>(&cell)) return std::to_string(*whole);
  if (const auto* real = std::get_if<double>(&cell)) return to_text(*real);
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return "";
}

}  // namespace

std::string cell_text(double value, int digits) {
  return std::isfinite(value) ? significant(value, digits) : "-";
}

std::string counts_text(const CompareSummary& sum) {
  return std::to_string(sum.solved) + " / " + std::to_string(sum.valid) + " / " + std::to_string(sum.total);
}

std::string success_text(const CompareSummary& sum) {
  if (sum.total == 0) return "-";
  const double share = static_cast<double>(sum.valid) / static_cast<double>(sum.total);
  const auto [low, high] = wilson_interval(share, sum.effective_runs);
  return significant(100.0 * share, 3) + " (" + significant(100.0 * low, 3) + " to " +
         significant(100.0 * high, 3) + ")";
}

std::string unsolved_text(const CompareSummary& sum) {
  std::string text;
  for (const auto& [status, count] : sum.unsolved) {
    text += (text.empty() ? "" : ", ") + status + " " + std::to_string(count);
  }
  return text.empty() ? "-" : text;
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
  std::vector<std::vector<std::string>> rows{
      {"planner", "arrived / valid / total", "safe", "outrun", "refused", "motion s", "least separation mm",
       "below d_s mm", "allowed below mm", "top accel. % of limit", "computed in s", "not arrived"}};
  for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
    const CompareSummary sum = summary(experiment, i);
    rows.push_back({experiment.planners[i].label, counts_text(sum), std::to_string(sum.safe),
                    std::to_string(sum.outrun), std::to_string(sum.refused), cell_text(sum.motion_median),
                    cell_text(1000.0 * sum.least_separation), cell_text(1000.0 * sum.worst_shortfall),
                    cell_text(1000.0 * sum.allowed_shortfall), cell_text(100.0 * sum.top_acceleration, 3),
                    cell_text(sum.time_median), unsolved_text(sum)});
  }
  return rows;
}

}  // namespace

std::string length_unit(const CompareExperiment& experiment) {
  const auto& slides = experiment.is_prismatic;
  if (std::find(slides.begin(), slides.end(), true) == slides.end()) return "rad";
  return std::find(slides.begin(), slides.end(), false) == slides.end() ? "m" : "rad and m";
}

std::string work_text(const CompareSummary& sum) {
  const WorkTimes& work = sum.work_mean;
  const double whole = work.search.value_or(0.0) + work.shortcuts.value_or(0.0) + work.proofs.value_or(0.0);
  if (!(whole > 0.0)) return "-";
  const auto percent = [&](const std::optional<double>& part) {
    return part ? std::to_string(std::lround(100.0 * *part / whole)) : "-";
  };
  return percent(work.search) + " / " + percent(work.shortcuts) + " / " + percent(work.proofs);
}

std::vector<std::vector<std::string>> summary_table(const CompareExperiment& experiment) {
  if (experiment.setup.teams) return team_table(experiment);
  std::vector<std::vector<std::string>> rows{
      {"planner", "solved / valid / total", "median s", "p95 s", "CPU s", "search / shortcuts / proofs %",
       "check CPU s", "cost J", "length " + length_unit(experiment), "steps", "unsolved"}};
  for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
    const CompareSummary sum = summary(experiment, i);
    rows.push_back({experiment.planners[i].label, counts_text(sum), cell_text(sum.time_median),
                    cell_text(sum.time_p95), cell_text(sum.cpu_median), work_text(sum),
                    cell_text(sum.check_median), cell_text(sum.cost_median, 4),
                    cell_text(sum.length_median, 4), cell_text(sum.steps_median, 6), unsolved_text(sum)});
  }
  return rows;
}

std::string csv_header() {
  std::vector<std::string> header{"suite", "experiment", "world", "problem"};
  for (const RunColumn& column : run_columns()) header.push_back(column.name);
  return csv_row(header);
}

std::string csv_rows(const std::string& suite, const std::string& experiment,
                     const std::vector<ComparePlanner>& planners, const CompareProblem& problem) {
  std::string text;
  for (const CompareRun& run : problem.runs) {
    std::vector<std::string> row{suite, experiment, problem.world, problem.name};
    for (const RunColumn& column : run_columns())
      row.push_back(csv_text(column.cell(run, planners[run.planner])));
    text += csv_row(row);
  }
  return text;
}

std::string to_csv(const CompareResults& results) {
  std::string text = csv_header();
  for (const CompareExperiment& experiment : results.experiments) {
    for (const CompareProblem& problem : experiment.problems)
      text += csv_rows(results.suite, experiment.setup.name, experiment.planners, problem);
  }
  return text;
}

std::string to_json(const CompareResults& results) {
  Json json = head_of(results);
  json["notes"] = results.notes;
  json["time_s"] = results.time;
  json["experiments"] = Json::array();
  json["overview"] = overview_json(overview(results));
  json["resolutions"] = sweeps_json(results);
  json["broken_promises"] = broken_promises(results);
  for (const CompareExperiment& experiment : results.experiments) {
    Json planners = Json::array();
    for (std::size_t i = 0; i < experiment.planners.size(); ++i) {
      planners.push_back(summary_json(experiment, i));
    }
    json["experiments"].push_back({{"name", experiment.setup.name},
                                   {"title", experiment.setup.title},
                                   {"problems", experiment.problems.size()},
                                   {"runs", experiment.setup.runs},
                                   {"time_limit_s", number_or_null(experiment.time_limit)},
                                   {"planners", planners}});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway
