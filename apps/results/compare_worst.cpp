#include "apps/results/compare_worst.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>

#include "apps/results/compare_files.hpp"

namespace clearway {
namespace {

constexpr WorstCase::Kind worst_kinds[] = {WorstCase::failed, WorstCase::slowest, WorstCase::tightest,
                                           WorstCase::dearest};

/// J of the best valid path to a problem; infinity without one.
double best_cost(const CompareProblem& problem) {
  double best = std::numeric_limits<double>::infinity();
  for (const CompareRun& run : problem.runs)
    if (run.is_valid()) best = std::min(best, run.cost);
  return best;
}

/// Not a number for runs that this kind is not about.
double badness(const CompareRun& run, WorstCase::Kind kind, double best) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (run.is_valid() == (kind == WorstCase::failed)) return none;
  switch (kind) {
    case WorstCase::failed:
    case WorstCase::slowest:
      return run.time;
    case WorstCase::tightest:
      return std::isfinite(run.min_clearance) ? -run.min_clearance : none;
    case WorstCase::dearest:
      return best > 0.0 ? run.cost / best : 1.0;
  }
  return none;
}

std::optional<WorstCase> worst_of(const CompareExperiment& experiment, std::size_t planner,
                                  WorstCase::Kind kind) {
  std::optional<WorstCase> worst;
  for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
    const CompareProblem& problem = experiment.problems[i];
    const double best = kind == WorstCase::dearest ? best_cost(problem) : 0.0;
    for (std::size_t r = 0; r < problem.runs.size(); ++r) {
      if (problem.runs[r].planner != planner) continue;
      const double bad = badness(problem.runs[r], kind, best);
      if (std::isnan(bad) || (worst && bad <= worst->badness)) continue;
      worst = WorstCase{kind, i, r, bad};
    }
  }
  return worst;
}

const CompareRun& run_of(const CompareExperiment& experiment, const WorstCase& worst) {
  return experiment.problems[worst.problem].runs[worst.run];
}

/// The worst of each kind come first.
std::vector<WorstCase> most_wanted(const CompareExperiment& experiment) {
  const std::vector<WorstCase> all = worst_cases(experiment);
  std::vector<WorstCase> wanted;
  for (const WorstCase::Kind kind : worst_kinds) {
    const WorstCase* first = nullptr;
    for (const WorstCase& worst : all)
      if (worst.kind == kind && (first == nullptr || worst.badness > first->badness)) first = &worst;
    if (first != nullptr) wanted.push_back(*first);
  }
  wanted.insert(wanted.end(), all.begin(), all.end());
  return wanted;
}

/// A page shows the plans of all planners with that number, in their order.
std::size_t place_on_page(const CompareProblem& problem, const CompareRun& run) {
  return static_cast<std::size_t>(
      std::count_if(problem.runs.begin(), problem.runs.end(), [&](const CompareRun& other) {
        return other.number == run.number && other.planner < run.planner && !other.plan_file.empty();
      }));
}

}  // namespace

const char* to_string(WorstCase::Kind kind) {
  switch (kind) {
    case WorstCase::failed:
      return "failed";
    case WorstCase::slowest:
      return "slowest";
    case WorstCase::tightest:
      return "tightest";
    case WorstCase::dearest:
      return "dearest";
  }
  return "";
}

std::vector<WorstCase> worst_cases(const CompareExperiment& experiment) {
  std::vector<WorstCase> all;
  if (experiment.setup.teams) return all;
  for (std::size_t p = 0; p < experiment.planners.size(); ++p)
    for (const WorstCase::Kind kind : worst_kinds)
      if (const auto worst = worst_of(experiment, p, kind)) all.push_back(*worst);
  return all;
}

std::vector<WorstPage> worst_pages(const CompareExperiment& experiment, std::size_t most) {
  std::vector<WorstPage> pages;
  for (const WorstCase& worst : most_wanted(experiment)) {
    const int number = run_of(experiment, worst).number;
    const bool is_there = number == 1 && !experiment.problems[worst.problem].page.empty();
    const bool is_listed = std::any_of(pages.begin(), pages.end(), [&](const WorstPage& page) {
      return page.problem == worst.problem && page.number == number;
    });
    if (!is_there && !is_listed && pages.size() < most) pages.push_back({worst.problem, number});
  }
  return pages;
}

std::filesystem::path worst_page_file(const CompareExperiment& experiment, const CompareProblem& problem,
                                      int number) {
  const std::string seed = experiment.setup.runs > 1 ? "-" + std::to_string(number) : "";
  return std::filesystem::path("worst") / name_as_file(experiment.setup.name) /
         (name_as_file(problem.name) + seed + ".html");
}

void link_worst_pages(const std::filesystem::path& folder, CompareExperiment& experiment) {
  for (const WorstCase& worst : worst_cases(experiment)) {
    CompareProblem& problem = experiment.problems[worst.problem];
    CompareRun& run = problem.runs[worst.run];
    std::filesystem::path page = worst_page_file(experiment, problem, run.number);
    std::error_code error;
    if (run.number == 1 && !problem.page.empty())
      page = problem.page;
    else if (!std::filesystem::exists(folder / page, error))
      continue;
    run.page = page.generic_string();
    if (!run.plan_file.empty()) run.page += "#plan=" + std::to_string(place_on_page(problem, run));
  }
}

}  // namespace clearway
