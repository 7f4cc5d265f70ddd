#pragma once

#include <span>
#include <vector>

#include "planning/constraint/active_normals.hpp"
#include "planning/constraint/normalized_constraints.hpp"

namespace clearway {

/// min 1/2 ||x - target||^2  subject to  a_i x <= b_i,  lower <= x <= upper, by the dual active-set method of
/// Goldfarb and Idnani (1983) with Hessian = identity: constraints are taken up one by one, the most violated
/// first, and those that block are let go, until none is violated.
///
/// For loops that solve a problem each few microseconds: an object keeps its memory and allocates nothing
/// once it has seen its largest problem. `solve` in quadratic_program.hpp is the easy call.
/// Constraints are numbered: 0..m-1 the inequalities, m+j the upper limit of x_j, m+n+j its lower limit.
/// Never NaN; the same problem gives the same bits on every machine.
class QuadraticSolver {
 public:
  /// Forgets the last problem: n variables, target 0, no inequalities, no limits.
  void begin(int variables);
  /// @throws std::invalid_argument for NaN or numbers beyond 1e100.
  void set_target(std::span<const double> target);
  /// Infinite is no limit. @throws std::invalid_argument when lower > upper, or NaN.
  void set_limits(std::span<const double> lower, std::span<const double> upper);
  /// a x <= bound; an infinite bound, or one that only |x| > 1e100 could reach, is no constraint.
  /// @throws std::invalid_argument for a bound that is NaN or -infinity; for NaN or numbers beyond 1e150 in
  ///         the constraint when it is solved.
  void add_constraint(std::span<const double> normal, double bound);

  /// Solves what was given. False: infeasible, and multipliers() is the proof; all zero when rounding ended
  /// the search without one.
  bool solve();

  /// The same; when it is infeasible, constraints that demand motion (negative bounds) give way, and only
  /// those that take part in a contradiction: each such proof (constraints i with weights y_i) lowers the
  /// shares s_i of their bounds to the largest common cap that ends it. So the limits always hold, then the
  /// constraints that forbid approach, and the smallest share is the largest possible one: the worst relative
  /// shortfall is least. False only by rounding. @pre lower <= 0 <= upper, so that x = 0 is feasible with all
  /// shares 0.
  bool solve_relaxed();

  int variables() const { return constraints_.variables(); }
  int inequalities() const { return constraints_.inequalities(); }
  std::span<const double> x() const { return {x_.data(), static_cast<std::size_t>(variables())}; }
  /// Feasible: Lagrange multipliers >= 0, x = target - sum multiplier_i a_i.
  /// Infeasible: a Farkas certificate: sum y_i a_i = 0, y >= 0, sum y_i b_i < 0; or all zero: none found.
  std::span<const double> multipliers() const { return multipliers_; }
  /// A constraint of the contradiction, at which it was found (in solve_relaxed: the first one); -1 when
  /// feasible.
  int conflicting() const { return conflicting_; }
  int iterations() const { return iterations_; }
  /// Of each constraint's bound what solve_relaxed kept; 1 for constraints that did not give way.
  std::span<const double> shares() const { return shares_; }
  double smallest_share() const;

 private:
  enum class Addition { added, contradicts, within_rounding };

  bool run();
  Addition add(const Violation& violation);
  bool is_real(const Violation& violation, double rest) const;
  void polish();
  void drop(int which);
  void report_proof(int last);
  void report_proof_by_limits();
  bool lower_shares();

  NormalizedConstraints constraints_;
  ActiveNormals normals_;
  std::vector<double> target_, x_;          ///< padded to whole lanes
  std::vector<int> active_;                 ///< constraints, as their normals are ordered
  std::vector<double> active_multipliers_;  ///< of these
  std::vector<double> active_bounds_;       ///< of these
  std::vector<unsigned char> is_out_;       ///< of each constraint: active, or found to hold within rounding
  std::vector<double> normal_, trial_;      ///< of the step under way
  std::vector<double> multipliers_, shares_;
  double target_size_ = 0.0;
  int conflicting_ = -1, iterations_ = 0;
};

}  // namespace clearway
