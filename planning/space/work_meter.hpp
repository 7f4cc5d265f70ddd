#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace clearway {

/// What the time of a query is spent on. Each moment counts once: a proof of an edge is a proof, whether a
/// search asks for it or what shortens a path.
enum class PlanWork {
  search,     ///< all that is not below: trees, lattices, local steps, routes, single configurations
  shortcuts,  ///< to shorten and to round a path that was found
  proofs      ///< to certify edges
};

/// Seconds by what they were spent on. None: a planner has no such work, or did not come to it.
struct WorkTimes {
  std::optional<double> search = std::nullopt, shortcuts = std::nullopt, proofs = std::nullopt;
};

/// Splits the time of a query by what the thread that made this meter works on. It looks at the wall clock
/// where the work changes, twice for each edge that is proved: to ask for a thread's CPU time takes longer
/// than many a proof.
class WorkMeter {
 public:
  /// What is done until the end of its scope; then the work goes on as before. Nothing without a meter, or in
  /// another thread than the meter's.
  class Scope {
   public:
    Scope(WorkMeter* meter, PlanWork work) : meter_(meter) {
      if (meter_ == nullptr) return;
      if (meter_->thread_ != std::this_thread::get_id())
        meter_ = nullptr;
      else
        before_ = meter_->turn_to(work);
    }
    ~Scope() {
      if (meter_ != nullptr) meter_->turn_to(before_);
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    WorkMeter* meter_;
    PlanWork before_ = PlanWork::search;
  };

  WorkMeter() { is_known_[place(PlanWork::search)] = true; }

  /// How `cpu` seconds of CPU since the meter was made, in its thread, split: in the shares of the wall
  /// clock, so that they add up to `cpu`.
  WorkTimes times(double cpu) const;

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t place(PlanWork work) { return static_cast<std::size_t>(work); }

  /// Returns what was worked on before.
  PlanWork turn_to(PlanWork work) {
    const Clock::time_point now = Clock::now();
    spent_[place(work_)] += now - since_;
    since_ = now;
    is_known_[place(work)] = true;
    return std::exchange(work_, work);
  }

  std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point since_ = Clock::now();
  PlanWork work_ = PlanWork::search;
  std::array<Clock::duration, 3> spent_{};
  std::array<bool, 3> is_known_{};
};

/// Both together.
WorkTimes operator+(const WorkTimes& a, const WorkTimes& b);

}  // namespace clearway
