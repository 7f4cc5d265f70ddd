#include "apps/results/compare_diff.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/console/quantile.hpp"
#include "apps/results/stored_results.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// New against old, problem by problem: medians over the runs that are valid in both.
PairedFigure change_of(const StoredRuns& before, const StoredRuns& after, double StoredRun::*figure) {
  std::map<std::string, std::pair<std::vector<double>, std::vector<double>>> problems;
  for (const auto& [key, run] : before) {
    const auto found = after.find(key);
    if (found == after.end() || !run.is_valid || !found->second.is_valid) continue;
    if (!(run.*figure > 0.0) || !(found->second.*figure > 0.0)) continue;
    auto& [old_values, new_values] = problems[std::get<0>(key)];
    old_values.push_back(run.*figure);
    new_values.push_back(found->second.*figure);
  }
  PairedFigure change;
  std::vector<double> logarithms;
  for (const auto& [problem, values] : problems) {
    logarithms.push_back(log_ratio(quantile(values.second, 0.5), quantile(values.first, 0.5)));
    change.less += logarithms.back() < 0.0;
  }
  change.problems = logarithms.size();
  if (logarithms.empty()) return change;
  change.p = signed_rank_test(logarithms);
  change.ratio = std::exp(quantile(logarithms, 0.5));
  change.other = median_of_others(logarithms);
  return change;
}

DiffRow row_of(const std::pair<std::string, std::string>& name, const StoredRuns& before,
               const StoredRuns& after) {
  DiffRow row{.experiment = name.first, .planner = name.second};
  std::map<std::string, int> gained;  ///< by problem
  for (const auto& [key, run] : before) {
    const auto found = after.find(key);
    if (found == after.end()) continue;
    const StoredRun& now = found->second;
    ++row.runs;
    row.lost += run.is_valid && !now.is_valid;
    row.lost_to_clock += run.is_valid && !now.is_valid && now.is_of_clock;
    row.won += !run.is_valid && now.is_valid;
    const bool costs_differ = !std::isnan(run.cost) && !std::isnan(now.cost) && run.cost != now.cost;
    row.other_paths += run.is_valid && now.is_valid && (costs_differ || run.length != now.length);
    gained[std::get<0>(key)] += int{now.is_valid} - int{run.is_valid};
  }
  std::size_t more = 0, fewer = 0;
  for (const auto& [problem, runs] : gained) {
    more += runs > 0;
    fewer += runs < 0;
  }
  row.success_p = sign_test(more, fewer);
  row.cpu = change_of(before, after, &StoredRun::cpu);
  row.cost = change_of(before, after, &StoredRun::cost);
  return row;
}

template <typename P>
void correct_rows(std::vector<DiffRow>& rows, const P& p_of) {
  std::vector<double> p_values;
  for (DiffRow& row : rows) p_values.push_back(p_of(row));
  const std::vector<double> corrected = holm_corrected(p_values);
  for (std::size_t i = 0; i < rows.size(); ++i) p_of(rows[i]) = corrected[i];
}

std::string percent(double ratio) {
  if (ratio >= 2.0) return "x " + significant(ratio, 3);
  const double change = 100.0 * (ratio - 1.0);
  return (change > 0.0 ? "+" : "") + significant(change, 3) + " %";
}

constexpr double beyond_chance = 0.05;

/// The smallest p value that the tests can give to changes of so many problems, all one way, of so many rows.
double least_p(std::size_t problems, std::size_t rows) {
  return static_cast<double>(rows) * std::ldexp(2.0, -static_cast<int>(problems));
}

/// Sorts into worse and better what is beyond noise.
void judge(DiffRow& row) {
  constexpr double drift = 0.05;
  constexpr std::size_t many_lost = 6, few_problems = 3;
  const bool loses_alone =  // the same seeds: no chance in it, or little where a clock ended them
      !row.is_external && row.won == 0 && (row.lost > row.lost_to_clock || row.lost >= many_lost);
  if (row.success_p < beyond_chance || loses_alone) {
    auto& words = row.lost > row.won ? row.worse : row.better;
    words.push_back("solves " + std::string(row.lost > row.won ? "fewer" : "more") + ": lost " +
                    std::to_string(row.lost) + ", won " + std::to_string(row.won) + " (p " +
                    p_text(row.success_p) + ")");
  }
  const auto judge_figure = [&](const PairedFigure& figure, const char* what, double least) {
    if (figure.p >= beyond_chance || std::abs(figure.effect() - 1.0) < least || figure.is_equal()) return;
    (figure.effect() > 1.0 ? row.worse : row.better)
        .push_back(std::string(what) + " " + percent(figure.effect()) +
                   (figure.is_of_others() ? " where it changed" : "") + " (p " + p_text(figure.p) + ")");
  };
  judge_figure(row.cpu, "CPU time", drift);
  const bool has_few = row.cpu.p >= beyond_chance && row.cpu.problems >= few_problems;
  const std::string on_each = " on each of " + counted(row.cpu.problems, "problem") + ")";
  if (has_few && row.cpu.less == 0 && row.cpu.ratio >= 2.0)
    row.worse.push_back("CPU time " + percent(row.cpu.ratio) + " (more" + on_each);
  if (has_few && row.cpu.less == row.cpu.problems && row.cpu.ratio <= 0.5)
    row.better.push_back("CPU time " + percent(row.cpu.ratio) + " (less" + on_each);
  judge_figure(row.cost, "path cost", 0.0);
}

using OfProblems = std::map<std::pair<std::string, std::string>, std::string>;

/// A sentence where problems of the same name had others of these; else empty.
std::string other_of_problems(const std::string& what, const OfProblems& before, const OfProblems& after) {
  std::size_t count = 0;
  std::string first;
  for (const auto& [problem, value] : before) {
    const auto found = after.find(problem);
    if (found == after.end() || found->second == value) continue;
    if (count++ == 0) first = "'" + plain(problem.second) + "' in experiment '" + plain(problem.first) + "'";
  }
  if (count == 0) return "";
  return "The " + what + " of " + counted(count, "problem") + " differ, as in " + first +
         ": what changed may be theirs.";
}

/// "padding (0.0, then 0.01)"
std::string other_value(const std::string& name, const std::string& before, const std::string& after) {
  return name + " (" + shortened(before.empty() ? "none" : before) + ", then " +
         shortened(after.empty() ? "none" : after) + ")";
}

/// "width (10, then 20), step (none, then 0.1)": of options in JSON those that differ.
std::string other_options(const std::string& before, const std::string& after) {
  using Json = nlohmann::ordered_json;
  const Json old_options = Json::parse(before, nullptr, false),
             new_options = Json::parse(after, nullptr, false);
  if (!old_options.is_object() || !new_options.is_object()) return "options";
  std::map<std::string, std::pair<std::string, std::string>> values;
  const auto text = [](const Json& value) {
    return value.is_string() ? value.get<std::string>() : std::string(value.type_name());
  };
  for (const auto& [name, value] : old_options.items()) values[name].first = text(value);
  for (const auto& [name, value] : new_options.items()) values[name].second = text(value);
  std::string differing;
  for (const auto& [name, value] : values)
    if (value.first != value.second)
      differing += (differing.empty() ? "" : ", ") + other_value(shortened(name), value.first, value.second);
  return differing;
}

void add_other_options(const StoredResults& before, const StoredResults& after,
                       std::vector<std::string>& notes) {
  for (const auto& [name, options] : before.options) {
    const auto found = after.options.find(name);
    if (found == after.options.end() || found->second == options) continue;
    if (const std::string differing = other_options(options, found->second); !differing.empty())
      notes.push_back("'" + plain(name.second) + "' in experiment '" + plain(name.first) +
                      "' was asked with another " + differing + ": what changed may be theirs.");
  }
}

void add_other_settings(const StoredResults& before, const StoredResults& after,
                        std::vector<std::string>& notes) {
  for (const auto& [experiment, settings] : before.settings) {
    const auto found = after.settings.find(experiment);
    if (found == after.settings.end()) continue;
    std::string differing;
    for (const auto& [name, value] : settings) {
      const std::string& now = found->second.at(name);
      if (now == value) continue;
      differing += (differing.empty() ? "" : ", ") + other_value(name, value, now);
    }
    if (!differing.empty())
      notes.push_back("Experiment '" + plain(experiment) + "' was asked with another " + differing +
                      ": what changed may be theirs.");
  }
}

/// Experiments of both whose digests differ.
std::vector<std::string> differing(const std::map<std::string, std::string>& before,
                                   const std::map<std::string, std::string>& after) {
  std::vector<std::string> names;
  for (const auto& [experiment, digest] : before)
    if (const auto found = after.find(experiment); found != after.end() && found->second != digest)
      names.push_back(experiment);
  return names;
}

std::vector<std::string> notes_on(const StoredResults& before, const StoredResults& after) {
  std::vector<std::string> notes;
  if (before.host != after.host || before.processor != after.processor)
    notes.push_back("The machines differ (" + before.host + ", " + after.host +
                    "): CPU times say more of them than of the planners.");
  if (before.jobs != after.jobs)
    notes.push_back("--jobs differ (" + before.jobs + ", " + after.jobs +
                    "): planners that share a machine slow each other down.");
  for (const std::string& experiment : differing(before.robots, after.robots))
    notes.push_back("The robots of experiment '" + plain(experiment) +
                    "' differ, as its files say something else: what changed may be theirs.");
  const std::string other_ends = other_of_problems("starts or goals", before.ends, after.ends);
  for (const std::string& other : {other_of_problems("maps", before.maps, after.maps), other_ends})
    if (!other.empty()) notes.push_back(other);
  if (other_ends.empty())
    for (const std::string& experiment : differing(before.problems, after.problems))
      notes.push_back("The problems of experiment '" + plain(experiment) +
                      "' differ, in their loads or in their number: what changed may be theirs.");
  add_other_settings(before, after, notes);
  add_other_options(before, after, notes);
  const auto report_missing = [&](const StoredResults& from, const StoredResults& in) {
    for (const auto& [name, runs] : from.runs) {
      const std::string who = "'" + plain(name.second) + "' in experiment '" + plain(name.first) + "'";
      const std::string alone = " in '" + plain(from.file.string()) + "' alone";
      const auto other = in.runs.find(name);
      if (other == in.runs.end()) {
        notes.push_back(who + " is" + alone + ".");
        continue;
      }
      const auto count = static_cast<std::size_t>(std::count_if(
          runs.begin(), runs.end(), [&](const auto& run) { return !other->second.contains(run.first); }));
      if (count > 0)
        notes.push_back("Of " + who + " " + std::to_string(count) + " of " + counted(runs.size(), "run") +
                        (count == 1 ? " is" : " are") + alone + ": nothing is said of " +
                        (count == 1 ? "it." : "them."));
    }
  };
  report_missing(before, after);
  report_missing(after, before);
  return notes;
}

/// Of the rows that lose runs which no test counts, and no rule.
std::string lost_by_externals(const std::vector<DiffRow>& rows) {
  std::string lost;
  for (const DiffRow& row : rows)
    if (row.is_external && row.lost > row.won && row.worse.empty())
      lost += (lost.empty() ? "" : ", ") + quote(row.planner) + " in experiment " + quote(row.experiment) +
              " lost " + std::to_string(row.lost) + ", won " + std::to_string(row.won);
  return lost.empty() ? "" : " Runs of external planners count only by the sign test: " + lost + ".";
}

}  // namespace

bool CompareDiff::is_worse() const {
  return std::any_of(rows.begin(), rows.end(), [](const DiffRow& row) { return !row.worse.empty(); });
}

std::string CompareDiff::verdict() const {
  if (is_worse()) return "Worse beyond noise.";
  const auto small =
      std::count_if(rows.begin(), rows.end(), [](const DiffRow& row) { return row.is_too_small; });
  const std::string lost = lost_by_externals(rows);
  if (small == 0)
    return (lost.empty() ? "Nothing is worse" : "Nothing is shown to be worse") +
           std::string(" beyond noise.") + lost;
  std::size_t needed = 1;
  while (least_p(needed, rows.size()) >= beyond_chance) ++needed;
  return "Nothing is shown to be worse; " + std::to_string(small) + " of " + counted(rows.size(), "row") +
         " could show only twice the CPU time, and more on each of three problems or more, or lost runs: "
         "expected " +
         std::to_string(needed) + " problems or more to tell less from noise." + lost;
}

CompareDiff compare_diff(const fs::path& before_file, const fs::path& after_file) {
  const StoredResults before = load_stored_results(before_file), after = load_stored_results(after_file);
  CompareDiff diff;
  for (const auto& [name, runs] : before.runs) {
    const auto found = after.runs.find(name);
    if (found == after.runs.end()) continue;
    if (DiffRow row = row_of(name, runs, found->second); row.runs > 0) diff.rows.push_back(std::move(row));
  }
  if (diff.rows.empty())
    throw std::invalid_argument("'" + plain(before.file.string()) + "' and '" + plain(after.file.string()) +
                                "' have no run in common: expected results of the same suite and seed" +
                                (before.seed == after.seed ? std::string()
                                                           : ", got seeds " + shortened(before.seed) +
                                                                 " and " + shortened(after.seed)));
  correct_rows(diff.rows, [](DiffRow& row) -> double& { return row.success_p; });
  correct_rows(diff.rows, [](DiffRow& row) -> double& { return row.cpu.p; });
  correct_rows(diff.rows, [](DiffRow& row) -> double& { return row.cost.p; });
  for (DiffRow& row : diff.rows) {
    row.is_external = before.externals.contains(row.planner) || after.externals.contains(row.planner);
    row.is_too_small = least_p(row.cpu.problems, diff.rows.size()) >= beyond_chance;
    judge(row);
  }
  diff.notes = notes_on(before, after);
  return diff;
}

std::vector<std::vector<std::string>> diff_table(const CompareDiff& diff) {
  std::vector<std::vector<std::string>> rows{
      {"experiment", "planner", "runs", "lost", "won", "other paths", "CPU", "cost", "beyond noise"}};
  for (const DiffRow& row : diff.rows) {
    std::string words;
    for (const std::string& word : row.worse) words += (words.empty() ? "WORSE: " : "; ") + word;
    for (std::size_t i = 0; i < row.better.size(); ++i)
      words += (i > 0 || !words.empty() ? "; " : "") + std::string(i == 0 ? "better: " : "") + row.better[i];
    const auto change = [](const PairedFigure& figure) {
      return figure.problems == 0 ? std::string("-") : percent(figure.ratio);
    };
    rows.push_back({row.experiment, row.planner, std::to_string(row.runs), std::to_string(row.lost),
                    std::to_string(row.won), std::to_string(row.other_paths), change(row.cpu),
                    change(row.cost), words.empty() ? "-" : words});
  }
  return rows;
}

std::string to_json(const CompareDiff& diff) {
  using Json = nlohmann::ordered_json;
  Json rows = Json::array();
  const auto figure_json = [](const PairedFigure& figure) {
    return Json{{"problems", figure.problems},
                {"ratio", figure.ratio},
                {"ratio_of_changed", figure.other},
                {"p", figure.p}};
  };
  for (const DiffRow& row : diff.rows)
    rows.push_back({{"experiment", row.experiment},
                    {"planner", row.planner},
                    {"runs", row.runs},
                    {"lost", row.lost},
                    {"won", row.won},
                    {"other_paths", row.other_paths},
                    {"success_p", row.success_p},
                    {"cpu", figure_json(row.cpu)},
                    {"cost", figure_json(row.cost)},
                    {"too_small", row.is_too_small},
                    {"worse", row.worse},
                    {"better", row.better}});
  return Json{{"worse", diff.is_worse()}, {"verdict", diff.verdict()}, {"rows", rows}, {"notes", diff.notes}}
      .dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway
