#include "apps/results/compare_overview.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "apps/console/parse.hpp"
#include "apps/results/compare_statistics.hpp"
#include "apps/results/compare_summary.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

/// A problem with a seed: experiment, problem, number of the run.
using SeededProblem = std::tuple<std::size_t, std::size_t, int>;

/// The runs of one label.
struct LabelRuns {
  OverviewRow row;
  std::map<SeededProblem, const CompareRun*> runs;
};

LabelRuns& of_label(std::vector<LabelRuns>& labels, const ComparePlanner& who) {
  const auto found = std::find_if(labels.begin(), labels.end(),
                                  [&](const LabelRuns& each) { return each.row.who.label == who.label; });
  if (found != labels.end()) return *found;
  labels.emplace_back().row.who = who;
  return labels.back();
}

void add(const CompareExperiment& experiment, std::size_t index, std::vector<LabelRuns>& labels) {
  for (std::size_t p = 0; p < experiment.planners.size(); ++p) {
    const ComparePlanner& who = experiment.planners[p];
    LabelRuns& label = of_label(labels, who);
    const std::size_t before = label.runs.size();
    for (std::size_t i = 0; i < experiment.problems.size(); ++i)
      for (const CompareRun& run : experiment.problems[i].runs)
        if (run.planner == p) label.runs[{index, i, run.number}] = &run;
    label.row.experiments += label.runs.size() > before;
    label.row.who.certified = label.row.who.certified && who.certified;
    const bool is_same = label.row.who.planner == who.planner && label.row.who.options == who.options;
    label.row.has_same_options = label.row.has_same_options && is_same;
  }
}

/// The same problem at several resolutions is one: its runs are no independent ones.
CompareSummary summary_of_keys(const std::set<SeededProblem>& keys, const LabelRuns& label,
                               const std::vector<std::size_t>& first_alike) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<const CompareRun*>> by_problem;
  for (const SeededProblem& key : keys)
    by_problem[{first_alike[std::get<0>(key)], std::get<1>(key)}].push_back(label.runs.at(key));
  std::vector<std::vector<const CompareRun*>> problems;
  for (auto& [problem, runs] : by_problem) problems.push_back(std::move(runs));
  return summary_of(problems);
}

/// Of each experiment the first one that differs from it in resolution alone, or itself.
std::vector<std::size_t> first_alike(const CompareResults& results) {
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> first;
  for (const CompareExperiment& experiment : results.experiments) {
    const std::string& alike = experiment.setup.alike;
    first.push_back(alike.empty() ? first.size() : known.emplace(alike, first.size()).first->second);
  }
  return first;
}

/// Those that every comparable planner solved with a valid path.
std::set<SeededProblem> shared_keys(const std::set<SeededProblem>& keys,
                                    const std::vector<LabelRuns>& labels) {
  std::set<SeededProblem> shared;
  const bool has_any = std::any_of(labels.begin(), labels.end(),
                                   [](const LabelRuns& label) { return label.row.is_comparable; });
  for (const SeededProblem& key : keys) {
    const bool is_shared = std::all_of(labels.begin(), labels.end(), [&](const LabelRuns& label) {
      return !label.row.is_comparable || label.runs.at(key)->is_valid();
    });
    if (has_any && is_shared) shared.insert(key);
  }
  return shared;
}

void sum_up(const std::set<SeededProblem>& shared, const std::vector<std::size_t>& alike, LabelRuns& label) {
  std::set<SeededProblem> own;
  for (const auto& [key, run] : label.runs) own.insert(key);
  label.row.all = summary_of_keys(own, label, alike);
  label.row.shared =
      summary_of_keys(label.row.is_comparable ? shared : std::set<SeededProblem>(), label, alike);
}

}  // namespace

bool CompareOverview::adds_up() const {
  return std::any_of(planners.begin(), planners.end(),
                     [](const OverviewRow& row) { return row.experiments > 1; });
}

CompareOverview overview(const CompareResults& results) {
  CompareOverview all;
  std::vector<LabelRuns> labels;
  for (std::size_t e = 0; e < results.experiments.size(); ++e) {
    const CompareExperiment& experiment = results.experiments[e];
    if (experiment.setup.teams) {
      ++all.teams;
      continue;
    }
    ++(experiment.problems.empty() ? all.without_runs : all.experiments);
    if (experiment.problems.empty()) continue;
    add(experiment, e, labels);
    const std::string unit = length_unit(experiment);
    all.length_unit = all.length_unit.empty() || all.length_unit == unit ? unit : "rad or m";
  }
  std::set<SeededProblem> keys;
  for (const LabelRuns& label : labels)
    for (const auto& [key, run] : label.runs) keys.insert(key);
  for (LabelRuns& label : labels) label.row.is_comparable = label.runs.size() == keys.size();
  const std::set<SeededProblem> shared = shared_keys(keys, labels);
  all.runs = keys.size();
  all.shared = shared.size();
  const std::vector<std::size_t> alike = first_alike(results);
  for (LabelRuns& label : labels) {
    sum_up(shared, alike, label);
    all.planners.push_back(label.row);
  }
  std::stable_partition(all.planners.begin(), all.planners.end(),
                        [](const OverviewRow& row) { return row.is_comparable; });
  return all;
}

std::vector<std::vector<std::string>> overview_table(const CompareOverview& all) {
  if (!all.adds_up()) return {};
  std::vector<std::vector<std::string>> rows{{"planner", "experiments", "solved / valid / total",
                                              "valid % (95 %)", "median s", "p95 s", "CPU s", "shared: s",
                                              "cost J", "length " + all.length_unit, "unsolved"}};
  for (const OverviewRow& row : all.planners)
    rows.push_back({row.who.label + (row.is_comparable ? "" : " *"),
                    std::to_string(row.experiments) + " of " + std::to_string(all.experiments),
                    counts_text(row.all), success_text(row.all), cell_text(row.all.time_median),
                    cell_text(row.all.time_p95), cell_text(row.all.cpu_median),
                    cell_text(row.shared.time_median), cell_text(row.shared.cost_median, 4),
                    cell_text(row.shared.length_median, 4), unsolved_text(row.all)});
  return rows;
}

std::vector<std::string> overview_notes(const CompareOverview& all) {
  const auto comparable = static_cast<std::size_t>(std::count_if(
      all.planners.begin(), all.planners.end(), [](const OverviewRow& row) { return row.is_comparable; }));
  std::vector<std::string> notes{"Times are of solved runs, whichever those are.", interval_note};
  if (comparable > 1)
    notes.push_back("Shared: medians over the " + std::to_string(all.shared) + " of " +
                    counted(all.runs, "run") + " that all planners" +
                    (comparable < all.planners.size() ? " without *" : "") + " solved with a valid path.");
  if (comparable < all.planners.size())
    notes.push_back("* ran only some of the " + counted(all.runs, "run") +
                    ": do not compare such a row with another; see the experiments.");
  std::string differing;
  for (const OverviewRow& row : all.planners)
    if (!row.has_same_options) differing += (differing.empty() ? "" : ", ") + row.who.label;
  if (!differing.empty())
    notes.push_back("Planner or options differ between experiments: " + differing + ".");
  if (all.without_runs > 0) notes.push_back("Not begun: " + counted(all.without_runs, "experiment") + ".");
  if (all.teams > 0) notes.push_back("Not counted: " + counted(all.teams, "experiment") + " of teams.");
  return notes;
}

Json overview_json(const CompareOverview& all) {
  if (!all.adds_up()) return nullptr;
  Json planners = Json::array();
  for (const OverviewRow& row : all.planners) {
    Json json = summary_json(row.who, row.all);
    json["same_options"] = row.has_same_options;
    json["experiments"] = row.experiments;
    json["comparable"] = row.is_comparable;
    json["shared"] = summary_json(row.who, row.shared);
    planners.push_back(json);
  }
  return {{"experiments", all.experiments},    {"experiments_without_runs", all.without_runs},
          {"experiments_of_teams", all.teams}, {"runs", all.runs},
          {"shared_runs", all.shared},         {"length_unit", all.length_unit},
          {"notes", overview_notes(all)},      {"planners", planners}};
}

}  // namespace clearway
