#include "apps/bench/page/page.hpp"

#include <ctime>

#include "apps/console/build_stamp.hpp"

namespace clearway::bench {
namespace {

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm date{};
  gmtime_r(&now, &date);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &date);
  return text;
}

std::string stolen_text(const MachineLoad& before, const MachineLoad& after) {
  const std::optional<double> share = stolen_share(before, after);
  return share ? percent(*share) : "–";
}

std::string load_text(const MachineLoad& before, const MachineLoad& after) {
  return figure(before.average) + " → " + figure(after.average);
}

std::string origin_text(const Origin& origin, const std::vector<Outcome>& outcomes) {
  Table table{"", {"commit", "`" + origin.commit + "`"}, {}};
  table.rows = {{"date", origin.date},
                {"machine", origin.machine.cpu + ", " + origin.machine.vectors + ", " +
                                std::to_string(origin.machine.cores) + " cores, " +
                                count_text(origin.machine.memory_gb) + " GB"}};
  if (!outcomes.empty()) {
    const MachineLoad &first = outcomes.front().before, &last = outcomes.back().after;
    table.rows.push_back({"load average, first → last", load_text(first, last)});
    table.rows.push_back({"CPU time stolen by other guests", stolen_text(first, last)});
  }
  return to_markdown(table);
}

std::string summary(const std::vector<Outcome>& outcomes) {
  Table table{"", {"benchmark", "ours", "peer", "unit", "ratio", "peer's name", "runs", "s", "load"}, {}};
  for (const Outcome& one : outcomes) {
    const BenchResult& result = one.result;
    const std::string link = "[" + one.name + "](#" + one.name + ")";
    const std::string load = load_text(one.before, one.after);
    if (!one.failure.empty()) {
      table.rows.push_back({link, "–", "–", "failed", "–", "–", "–", figure(one.seconds), load});
      continue;
    }
    table.rows.push_back({link, figure(result.ours), figure(result.peer), result.units(),
                          result.no_ratio.empty() ? figure(result.ratio()) : "–", result.peer_name,
                          std::to_string(result.runs), figure(one.seconds), load});
  }
  return to_markdown(table);
}

constexpr const char* how_to_read =
    R"(- **Repeat one:** `build/release/bin/clearway_bench NAME`; `--help` has the names and flags, `--json` all details.
- **Ratios** above 1 mean that ours is better. Each is of one statistic of as many samples on both sides, measured in
  turns. No ratio: the two sides answer different questions, and the text says which.
- **Times** are CPU times of one thread and medians, unless a column says otherwise.
- **Doubt:** cores of a cloud machine are shared with other guests. Trust ratios more than times, and neither to the
  last digit. Scenes are generated, unless `--input` names a file.

Correctness figures (problems, kills, mutations) are in [TRUST.md](../../TRUST.md).
)";

}  // namespace

Origin this_origin() { return {std::string(build_commit()), today(), this_machine()}; }

std::string section(const Outcome& outcome) {
  std::string text = "## " + outcome.name + "\n\n";
  if (!outcome.failure.empty()) return text + "Failed: " + outcome.failure + "\n";
  const BenchResult& result = outcome.result;
  text += wrapped(result.compared) + '\n';
  for (const Table& table : result.tables) text += '\n' + to_markdown(table);
  if (!result.no_ratio.empty()) text += '\n' + wrapped("No ratio: " + result.no_ratio) + '\n';
  return text + "\n" + std::to_string(result.runs) + (result.runs == 1 ? " run, " : " runs, ") +
         figure(outcome.seconds) + " s; load " + load_text(outcome.before, outcome.after) + ", stolen " +
         stolen_text(outcome.before, outcome.after) + ".\n";
}

std::string whole_page(const Origin& origin, const std::vector<Outcome>& outcomes) {
  std::string text =
      "# Benchmarks\n\nThe only page with figures of speed and quality. "
      "`clearway_bench all --markdown --out apps/bench/BENCHMARKS.md` wrote it.\n\n";
  text += origin_text(origin, outcomes) + '\n' + how_to_read + '\n' + summary(outcomes);
  for (const Outcome& outcome : outcomes) text += '\n' + section(outcome);
  return text + '\n' + closing_text();
}

}  // namespace clearway::bench
