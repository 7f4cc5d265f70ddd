#include "apps/compare/compare_session.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <ostream>
#include <stdexcept>

#include "apps/compare/worst_case_pages.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/results/compare_files.hpp"
#include "apps/results/compare_overview.hpp"
#include "apps/results/compare_resolutions.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/interruption.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_from(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string duration_text(double seconds) {
  if (seconds < 100.0) return significant(std::ceil(seconds)) + " s";
  if (seconds < 6000.0) return significant(std::ceil(seconds / 60.0)) + " min";
  return significant(std::ceil(seconds / 360.0) / 10.0) + " h";
}

/// Shows how far the whole comparison is: a bar on a terminal, else a line every ten seconds.
class TimeLeft {
 public:
  TimeLeft(std::size_t all, std::size_t had, Console& console) : all_(all), had_(had), console_(console) {}

  void report(const std::string& experiment, std::size_t done) {
    constexpr double period = 10.0;
    const double now = seconds_from(begin_);
    if (!console_.is_terminal() && now - reported_ < period) return;
    reported_ = now;
    const std::string text =
        experiment + ": " + std::to_string(done) + " of " + std::to_string(all_) + " runs" + left(done, now);
    if (!console_.is_terminal()) return console_.log("clearway: " + text);
    console_.progress(text, static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(all_, 1)));
  }

 private:
  std::string left(std::size_t done, double now) const {
    if (done <= had_ || done >= all_) return "";
    const double each = now / static_cast<double>(done - had_);
    return ", about " + duration_text(each * static_cast<double>(all_ - done)) + " left";
  }

  std::size_t all_, had_;
  Console& console_;
  Clock::time_point begin_ = Clock::now();
  double reported_ = 0.0;
};

/// A killed process may have left half a line.
void cut_after_last_line(const fs::path& file) {
  const std::string text = read_input(file, "runs", SIZE_MAX);
  const std::size_t whole = text.rfind('\n') + 1;
  if (whole != text.size() && ::truncate(file.c_str(), static_cast<off_t>(whole)) != 0) fail_to_write(file);
}

std::string runs_are(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " finished run is" : " finished runs are");
}

}  // namespace

void print_experiment(const CompareExperiment& experiment, Console& console) {
  const std::string title = experiment.setup.title.empty() ? "" : ": " + experiment.setup.title;
  console.out() << "== " << experiment.setup.name << title << '\n';
  print_table(console.out(), summary_table(experiment));
  if (experiment.setup.teams)
    console.out()
        << "  Least separation, below d_s and top acceleration are of the runs that were not outrun.\n";
  console.out() << '\n' << std::flush;
}

void print_sums(const CompareResults& results, Console& console) {
  for (const ResolutionSweep& sweep : resolution_sweeps(results)) {
    console.out() << "== effect of resolution: " << sweep_name(results, sweep) << '\n';
    print_table(console.out(), sweep_table(results, sweep));
    console.out() << "  " << sweep_note(sweep) << "\n\n";
  }
  const CompareOverview all = overview(results);
  if (!all.adds_up()) return;
  console.out() << "== all experiments" << (all.without_runs > 0 ? " so far" : "") << '\n';
  print_table(console.out(), overview_table(all));
  for (const std::string& note : overview_notes(all)) console.out() << "  " << note << '\n';
  console.out() << '\n' << std::flush;
}

void print_results(const CompareResults& results, Console& console) {
  if (console.json) {
    console.out() << to_json(results) << std::endl;
    return;
  }
  for (const CompareExperiment& experiment : results.experiments)
    if (!experiment.problems.empty()) print_experiment(experiment, console);
  print_sums(results, console);
}

std::vector<std::string> runs_without_answer(const CompareResults& results) {
  std::vector<std::string> sentences;
  for (const CompareExperiment& experiment : results.experiments)
    for (const CompareProblem& problem : experiment.problems)
      for (const CompareRun& run : problem.runs)
        if (!run.ended.empty())
          sentences.push_back("run '" + run_id(experiment, problem, run) + "': " + run.ended + ": " +
                              run.explanation);
  return sentences;
}

/// What was found in `folder`. @throws std::invalid_argument when it is not of what is asked.
CompareRecords read_same(const fs::path& folder, const CompareAsked& asked) {
  CompareRecords records = CompareRecords::read(folder / records_name);
  const std::string differs = difference(asked, records.asked());
  const CompareShard &mine = asked.shard, &its = records.asked().shard;
  if (!differs.empty() || mine.index != its.index || mine.count != its.count)
    throw std::invalid_argument(
        "--resume: '" + folder.string() + "' is of another comparison: expected " +
        (differs.empty() ? "the same --shard" : "the same as now, but it differs in " + differs));
  return records;
}

std::optional<CompareResults> finished_results(
    const fs::path& folder, const CompareAsked& asked,
    const std::function<std::size_t(const CompareRecords&)>& runs) {
  if (fs::exists(AtomicFolder::partial_of(folder)) || !fs::exists(folder / records_name)) return std::nullopt;
  const CompareRecords records = read_same(folder, asked);
  if (records.count() < runs(records)) return std::nullopt;
  for (const auto& [experiment, stage] : records.stages())
    for (const CompareRecords::Problem& problem : *records.stage(experiment, stage))
      if (!problem.is_finished && !problem.found.runs.empty()) return std::nullopt;
  return records.results(folder);
}

void require_nothing_unfinished(const fs::path& folder) {
  const fs::path partial = AtomicFolder::partial_of(folder);
  std::size_t runs = 0;
  try {
    if (!fs::exists(partial / records_name)) return;
    if (!lock(open_to_read(partial), false)) return;  // another process writes it, which is told
    runs = CompareRecords::read(partial / records_name).count();
  } catch (const std::exception&) {  // none that could be gone on with
  }
  if (runs == 0) return;
  throw std::invalid_argument(
      "--out: " + quote_path(partial.string()) + " holds " + std::to_string(runs) +
      (runs == 1 ? " run" : " runs") +
      " of a comparison that did not end, expected --resume, which goes on with it, or "
      "that folder removed");
}

CompareRecords CompareSession::begin(AtomicFolder& folder, CompareAsked asked, bool resumes) {
  const fs::path file = folder.path() / records_name;
  if (!resumes || !fs::exists(file)) {
    CompareRecords records(asked);
    save_file(file, records.text());
    return records;
  }
  CompareRecords records = read_same(folder.path(), asked);
  cut_after_last_line(file);
  return records;
}

CompareSession::CompareSession(AtomicFolder& folder, CompareAsked asked, bool resumes)
    : folder_(folder),
      records_(begin(folder, std::move(asked), resumes)),
      file_(::open((folder.path() / records_name).c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC)) {
  if (!file_.is_open()) fail_to_write(folder.path() / records_name);
  records_.go_on([this](const std::string& line) { append(line); });
}

/// In the file at once, on the disk with every eighth line.
void CompareSession::append(const std::string& line) {
  constexpr int lines_a_sync = 8;
  const fs::path file = folder_.path() / records_name;
  write_all(file_, line, file);
  if (++lines_ % lines_a_sync == 0 && ::fdatasync(file_.number()) != 0) fail_to_write(file);
}

CompareResults CompareSession::run(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
                                   const CompareChoice& choice, Console& console) {
  std::size_t all = 0, before = 0;
  for (std::size_t e = 0; e < prepared.size(); ++e) all += count_runs(suite, prepared[e], e, choice);
  TimeLeft time_left(all, records_.count(), console);
  Clock::time_point begin = Clock::now();
  std::mutex printing;
  const auto keep_tables = [&](std::size_t end) {
    records_.add_time(seconds_from(begin));
    begin = Clock::now();
    const CompareResults results = records_.results(folder_.path(), end);
    save_results(results, folder_.path());
    return results;
  };
  const UnfinishedWork interrupted([&]() -> std::string {
    if (records_.count() == 0) return "";
    try {
      const std::lock_guard lock(printing);
      print_results(keep_tables(SIZE_MAX), console);
      folder_.note_progress(runs_are(records_.count()));
      return std::to_string(records_.count()) + " of " + std::to_string(all) +
             " runs are done, and --resume goes on";
    } catch (const std::exception& error) {
      return error.what();
    }
  });
  for (std::size_t e = 0; e < prepared.size(); ++e) {
    std::size_t done_here = 0;
    run_experiment(suite, prepared[e], e, choice, records_, [&](std::size_t done, std::size_t) {
      if (done > done_here) folder_.note_progress(runs_are(records_.count()));
      done_here = done;
      time_left.report(prepared[e].setup.name, before + done);
    });
    before += count_runs(suite, prepared[e], e, choice);
    console.progress(prepared[e].setup.name, 1.0);
    draw_worst_pages(suite, prepared[e], e, choice, records_, console);
    const CompareResults results = keep_tables(e + 1);  // an interruption holds files, then `printing`
    const std::lock_guard lock(printing);
    if (!console.json && !results.experiments.back().problems.empty())
      print_experiment(results.experiments.back(), console);
  }
  if (choice.shard.count == 1) records_.require_problems();  // another shard may have some
  CompareResults results = records_.results(folder_.path());
  save_file(folder_.path() / records_name, records_.text());
  const std::lock_guard lock(printing);
  if (!console.json) print_sums(results, console);
  return results;
}

}  // namespace clearway
