#pragma once

#include <span>
#include <vector>

namespace clearway {

/// A constraint that a point breaks: by `depth`, in units of its unit normal.
struct Violation {
  int constraint = -1;  ///< -1: none but those that do not count
  double depth = 0.0;
  bool is_lost = false;  ///< some constraint, counted or not, is broken by far more than rounding explains
};

/// Private to QuadraticSolver: the constraints a x <= b of a problem and the limits of x, with unit normals.
/// Constraints are numbered: 0..m-1 the inequalities, m+j the upper limit of x_j, m+n+j its lower limit.
class NormalizedConstraints {
 public:
  void begin(int variables);
  /// @throws std::invalid_argument when lower > upper, or NaN.
  void set_limits(std::span<const double> lower, std::span<const double> upper);
  /// @throws std::invalid_argument for a bound that is NaN or -infinity.
  void add(std::span<const double> normal, double bound);
  /// Divides the constraints that were added since by their lengths.
  /// @throws std::invalid_argument for numbers that are NaN or beyond 1e150.
  void normalise();

  int variables() const { return n_; }
  int inequalities() const { return m_; }
  int size() const { return m_ + 2 * n_; }

  /// The constraint that x breaks most, by more than rounding; ties: the first.
  /// @param size of the numbers whose difference x is. @param is_out those that do not count.
  Violation most_violated(const double* x, double size, const std::vector<unsigned char>& is_out) const;

  /// Length of the farthest x within the limits; infinite without limits.
  double farthest_within_limits() const;

  double bound(int constraint) const;
  double value(int constraint, const double* x) const;  ///< a x
  double length(int constraint) const;                  ///< what it was divided by; 1 for limits
  void load(int constraint, double* normal) const;      ///< padded with zeros

  /// A constraint's bound as it was given, if it is negative; else 0.
  double demand(int constraint) const { return demands_[static_cast<std::size_t>(constraint)]; }
  void lower_demand(int constraint, double share) {
    bounds_[static_cast<std::size_t>(constraint)] = share * demands_[static_cast<std::size_t>(constraint)];
  }

 private:
  void normalise_alone(int constraint);
  Violation one_by_one(const double* x, double tolerance, const std::vector<unsigned char>& is_out) const;

  int n_ = 0, m_ = 0, ready_ = 0;
  std::vector<double> normals_;  ///< in blocks of four: the first numbers of four, the second ones, ...
  std::vector<double> bounds_, demands_, lengths_;  ///< as long as whole blocks: beyond m_ no constraint
  std::vector<double> lower_, upper_;
};

}  // namespace clearway
