#include "apps/bench/page/run.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace clearway::bench {
namespace {

constexpr const char* clear_line = "\r\033[K";

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

/// Shows one benchmark's progress.
class Line {
 public:
  Line(Progress& progress, std::string begin) : progress_(progress), begin_(std::move(begin)) { show(""); }

  void show(const std::string& run) {
    if (progress_.is_terminal) {
      progress_.log << clear_line << begin_ << run << std::flush;
    } else if (progress_.each_run && !run.empty()) {
      progress_.log << begin_ << run << '\n' << std::flush;
    }
  }
  void end(const std::string& how) {
    progress_.log << (progress_.is_terminal ? clear_line : "") << begin_ << how << '\n' << std::flush;
  }

 private:
  Progress& progress_;
  std::string begin_;
};

Outcome run_one(const Entry& entry, BenchOptions options, Line& line) {
  Outcome outcome{entry.name, entry.what, {}, {}, 0.0, machine_load(), {}};
  if (options.runs == 0) options.runs = entry.runs;
  options.progress = [&](const std::string& what) { line.show(what); };
  const auto begin = std::chrono::steady_clock::now();
  try {
    outcome.result = entry.run(options);
  } catch (const std::exception& error) {
    outcome.failure = error.what();
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.after = machine_load();
  const std::string took = seconds_text(outcome.seconds);
  line.end(outcome.failure.empty() ? took : "failed after " + took + ": " + outcome.failure);
  return outcome;
}

}  // namespace

std::vector<Outcome> run_benchmarks(const std::vector<Entry>& entries, const BenchOptions& options,
                                    Progress progress, const std::function<void(const Outcome&)>& done) {
  std::vector<Outcome> outcomes;
  for (const Entry& entry : entries) {
    Line line(progress, entry.name + " (" + std::to_string(outcomes.size() + 1) + " of " +
                            std::to_string(entries.size()) + "): ");
    outcomes.push_back(run_one(entry, options, line));
    done(outcomes.back());
  }
  return outcomes;
}

int exit_status(const std::vector<Outcome>& outcomes) {
  return std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& one) { return one.failure.empty(); })
             ? 0
             : 1;
}

}  // namespace clearway::bench
