#pragma once

#include <deque>
#include <string>
#include <vector>

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// A local step shorter than this share of the wanted one is a deadlock.
inline constexpr double deadlock_share = 1e-4;

/// The trace of a robot that moves step by step; each step is an edge that the configuration space certifies
/// before it is taken.
class CertifiedMotion {
 public:
  CertifiedMotion(const PlanProblem& problem, const DamperOptions& options);

  const Configuration& position() const { return trace_.back(); }
  Eigen::VectorXd weighted_position() const { return options_.weight.cwiseProduct(position()); }
  double distance_to_goal() const;  ///< Lahouar 2006, eq. 21, weighted units
  bool is_at_goal() const { return position() == problem_.goal; }
  int steps() const { return static_cast<int>(trace_.size()) - 1; }
  const WaypointOrigin& last_origin() const { return origins_.back(); }

  /// Moves by `step` (weighted units), or by its half, quarter, ... 1/1024 when only that is certified free.
  /// A step that ends within rounding of the goal ends at the goal. False: nothing could be certified.
  /// @param origin what kind of step it is; its number is set here
  bool take(const Eigen::VectorXd& step, WaypointOrigin origin = {PathPhase::free_motion});

  /// Notes what the constraints at the present position say, for the statistics.
  void note(const StepConstraints& constraints, const LocalStep& step);

  /// Turns the trace into a result: the waypoints when at the goal, else `status` and `explanation`.
  PlanResult result(PlanResult result, PlanStatus status, const std::string& explanation) const;

 private:
  Configuration moved(const Eigen::VectorXd& step) const;

  const PlanProblem& problem_;
  const DamperOptions& options_;
  std::vector<Configuration> trace_;
  std::vector<WaypointOrigin> origins_{{}};  ///< of the trace
  std::uint64_t edges_checked_ = 0;
  std::size_t most_constraints_ = 0;
  int shortened_ = 0, relaxed_ = 0;
  double least_separation_;
};

/// Detects that the local method creeps or rocks instead of coming nearer to the goal: over ten steps the
/// distance to the goal (strictly decreasing: Lahouar 2006, section 3.3) fell by less than a hundredth of one
/// step.
class CreepWatch {
 public:
  explicit CreepWatch(double max_step) : least_gain_(0.01 * max_step) {}
  bool is_creeping(double distance_to_goal);
  void restart() { last_.clear(); }

 private:
  double least_gain_;
  std::deque<double> last_;
};

/// What constraint number `source` (as LocalStep counts them) is about, in words that stay the same along a
/// boundary: "tool near what blocks it", "joint j2 near its upper limit". Empty: none.
std::string followed_name(const ConfigurationSpace& space, const StepConstraints& constraints, int source);

/// "tool is 1.2 mm from what blocks it at (x, y, z)" for the pair that holds the step back most (the largest
/// multiplier); joint limits are reported as such.
std::string holding_back(const ConfigurationSpace& space, const StepConstraints& constraints,
                         const Eigen::VectorXd& multipliers);

}  // namespace clearway
