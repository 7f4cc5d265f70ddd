#include "planning/auto_planner.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "mapping/system/parallel.hpp"
#include "planning/beam/beam_guided.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway {
namespace {

/// The planner of each round. Most queries need the first. Starting new trees early costs more than it gains:
/// how many samples a query needs depends on the query more than on the seed.
class Rounds {
 public:
  explicit Rounds(const AutoPlannerOptions& options) : options_(options) {}

  /// Null: there are no more.
  std::unique_ptr<Planner> planner(std::size_t round) const {
    constexpr int few = 10'000, many = 20'000;
    constexpr std::size_t doubled = 4;
    if (round == 0 || round == 2) return trees(few);
    if (round == 1) return local_method(0);
    if (round == 3)
      return std::make_unique<BeamGuided>(
          BeamGuidedOptions{.max_samples = std::min(few / 2, options_.max_samples),
                            .prismatic_scale = options_.prismatic_scale});
    std::int64_t samples = many;
    for (std::size_t i = doubled; i + 1 < round; i += 2) {
      if (samples > options_.max_samples) return nullptr;
      samples += std::min<std::int64_t>(samples, options_.max_samples);
    }
    return (round - doubled) % 2 == 0 ? trees(samples) : local_method(samples);
  }

 private:
  int at_most(std::int64_t samples) const {
    return static_cast<int>(std::min<std::int64_t>(samples, options_.max_samples));
  }
  std::unique_ptr<Planner> trees(std::int64_t samples) const {
    return std::make_unique<RrtConnect>(RrtConnectOptions{.prismatic_scale = options_.prismatic_scale,
                                                          .max_samples = at_most(samples),
                                                          .shortcuts = options_.shortcuts});
  }
  std::unique_ptr<Planner> local_method(std::int64_t samples) const {
    return std::make_unique<BoundaryPlus>(
        BoundaryPlusOptions{.max_samples = at_most(samples), .shortcuts = options_.shortcuts});
  }

  const AutoPlannerOptions& options_;
};

/// Rounds in turn, several at the same time where asked: the first of those that succeed counts, whichever
/// ends first, so that the number of threads changes nothing but the time.
class Race {
 public:
  Race(const PlanProblem& problem, const AutoPlannerOptions& options)
      : problem_(problem), rounds_(options), threads_(static_cast<std::size_t>(options.threads)) {}

  /// What each round up to the first that succeeded found, in turn. Nothing: not for this robot.
  std::vector<std::optional<PlanResult>> run() {
    parallel_until_false(threads_, [this] { return step(); });
    if (winner_ < found_.size()) found_.resize(winner_ + 1);
    return std::move(found_);
  }

 private:
  bool is_out_of_time() {
    const std::lock_guard lock(asking_);  // who asks for a plan need not think of threads
    return problem_.out_of_time();
  }

  bool step() {
    const std::size_t round = next_++;
    if (round > winner_ || is_out_of_time()) return false;
    const std::unique_ptr<Planner> planner = rounds_.planner(round);
    if (planner == nullptr) return false;
    PlanProblem problem = problem_;
    problem.seed = problem_.seed + round;
    problem.out_of_time = [&] { return round > winner_ || is_out_of_time(); };
    std::optional<PlanResult> result;
    try {
      result = planner->plan(problem);
    } catch (const std::invalid_argument&) {  // not for this robot
    }
    const bool is_solved = result && result->status == PlanStatus::solved;
    if (is_solved) result->explanation = planner->name() + ": " + result->explanation;
    const std::lock_guard lock(found_by_);
    if (found_.size() <= round) found_.resize(round + 1);
    found_[round] = std::move(result);
    if (is_solved && round < winner_) winner_ = round;
    return round < winner_;
  }

  const PlanProblem& problem_;
  Rounds rounds_;
  std::size_t threads_;
  std::atomic<std::size_t> next_ = 0, winner_ = std::numeric_limits<std::size_t>::max();
  std::mutex asking_, found_by_;
  std::vector<std::optional<PlanResult>> found_;
};

}  // namespace

AutoPlannerOptions read_options(OptionReader& reader, AutoPlannerOptions initial) {
  return {.prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000),
          .shortcuts = reader.integer("shortcuts", initial.shortcuts, 0, 1000000),
          .threads = reader.integer("threads", initial.threads, 1, 64)};
}

AutoPlanner::AutoPlanner(const AutoPlannerOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult AutoPlanner::plan(const PlanProblem& problem) const {
  PlanResult best = check_ends(problem);
  if (best.status != PlanStatus::solved) return best;
  if (problem.start.size() == 1 && !problem.space.is_edge_free(problem.start, problem.goal)) {
    best.status = PlanStatus::no_path;
    best.explanation = "The only way of a single joint, straight to the goal, is not free.";
    ++best.edges_checked;
    return best;
  }
  std::uint64_t configurations = best.configurations_checked, edges = best.edges_checked;
  std::vector<std::optional<PlanResult>> found = Race(problem, options_).run();
  bool is_solved = false;
  for (std::size_t round = 0; round < found.size(); ++round) {
    if (!found[round]) continue;
    configurations += found[round]->configurations_checked;
    edges += found[round]->edges_checked;
    is_solved = found[round]->status == PlanStatus::solved;
    if (is_solved || round == 0 || found[round]->final_distance < best.final_distance)
      best = std::move(*found[round]);
  }
  if (!is_solved) best.status = problem.out_of_time() ? PlanStatus::timed_out : PlanStatus::no_path;
  if (best.status == PlanStatus::timed_out && best.explanation.empty())
    best.explanation = "Out of time before a first try ended.";
  best.configurations_checked = configurations;
  best.edges_checked = edges;
  best.statistics["rounds"] = static_cast<double>(found.size());
  return best;
}

}  // namespace clearway
