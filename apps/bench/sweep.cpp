// What `clearway compare` costs a run beside planning, check and motion: a process, its files, its line, and
// the drawing of its problem.

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/page/bench_folder.hpp"
#include "apps/commands/command_line.hpp"
#include "apps/console/console.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr int few = 20, many = 120;  ///< problems

struct Sweep {
  double wall = 0.0, own = 0.0;  ///< s, of all runs; `own`: planned, checked, moved
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (c == ',' && !is_quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

/// Of all runs: what their planning, its check, its field and its motion took, s.
double own_time(const fs::path& results) {
  std::ifstream file(results / "results.csv");
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = cells_of(line);
  double sum = 0.0;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cells_of(line);
    for (const char* name : {"time_s", "check_s", "motion_cpu_s", "derive_cpu_s"}) {
      const auto column =
          static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      if (column < cells.size() && !cells[column].empty()) sum += std::stod(cells[column]);
    }
  }
  return sum;
}

Sweep sweep(const fs::path& folder, int problems) {
  const fs::path file = folder / ("sweep" + std::to_string(problems) + ".yaml");
  save_file(
      file,
      "time_limit: 10\nplanners: [{planner: rrtconnect}]\nexperiments:\n  - {name: cells, robot: puma560, "
      "padding: 0, policies: {default: not_occupied}, generate: {kind: cells, count: " +
          std::to_string(problems) + ", seed: 1, resolution: 0.04}}\n");
  std::ostringstream out, log;
  Console console(out, log);
  const fs::path results = folder / ("results" + std::to_string(problems));
  const double begin = wall_time();
  const int status = run_command_line({"compare", file.string(), "--out", results.string(), "--jobs", "1",
                                       "--worst-pages", "0", "--json", "--quiet"},
                                      console);
  const double wall = wall_time() - begin;
  if (status != exit_done) throw std::runtime_error("compare did not end well: " + log.str());
  Sweep done{wall, own_time(results)};
  fs::remove_all(results);
  return done;
}

}  // namespace

BenchResult bench_sweep(const BenchOptions& options) {
  const BenchFolder folder("sweep");
  std::vector<double> wall, own, overhead;
  for (int i = 0; i < options.runs; ++i) {
    options.say_run(i, options.runs);
    const Sweep small = sweep(folder.path, few), large = sweep(folder.path, many);
    wall.push_back((large.wall - small.wall) / (many - few));
    own.push_back((large.own - small.own) / (many - few));
    overhead.push_back(wall.back() - own.back());
  }
  BenchResult result{median(wall), median(own),  "the runs' own planning, check and motion", "s a problem",
                     true,         options.runs, {{"overhead_ms", 1e3 * median(overhead)}}};
  result.compared =
      "`clearway compare --jobs 1 --worst-pages 0` over " + std::to_string(many) + " and over " +
      std::to_string(few) +
      " problems of `generate: {kind: cells, resolution: 0.04}`, one planner: what a problem more takes, "
      "wall clock, against what its planning, check and smooth motion take within it. The rest is the "
      "drawing of the problem and its map, a process, a plan's file and a line of the record.";
  result.tables = {{"",
                    {"ms", ""},
                    {{"a problem more", figure(1e3 * median(wall))},
                     {"of it planning, check, motion", figure(1e3 * median(own))},
                     {"the rest", figure(1e3 * median(overhead))}}}};
  return result;
}

}  // namespace clearway::bench
