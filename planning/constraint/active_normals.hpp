#pragma once

#include <vector>

namespace clearway {

/// Private to QuadraticSolver: the unit normals of the active constraints as Q R, Q with orthonormal columns
/// and R upper triangular. A new normal is made orthogonal to Q (twice where that matters, Daniel et al.
/// 1976); one let go is turned out by Givens rotations. All vectors are padded to whole lanes.
class ActiveNormals {
 public:
  void begin(int variables);
  void clear() { count_ = 0; }
  int count() const { return count_; }

  /// Splits a normal: a = (active normals) weights + rest, the rest orthogonal to them. Returns the rest's
  /// length.
  double split(const double* normal);
  const double* rest() const { return rest_.data(); }
  const double* weights() const { return weights_.data(); }

  /// Takes up the normal that was split last. @pre its rest is not 0
  void append(double length_of_rest);
  void drop(int which);

  /// The point nearest to `target` with (normal i) x = bounds[i]: x = target - (normals) weights.
  void project(const double* target, const double* bounds, double* x);

 private:
  const double* column(int i) const { return q_.data() + static_cast<std::size_t>(i) * stride_; }
  double* column(int i) { return q_.data() + static_cast<std::size_t>(i) * stride_; }
  const double* factors(int i) const { return r_.data() + static_cast<std::size_t>(i) * stride_; }
  double* factors(int i) { return r_.data() + static_cast<std::size_t>(i) * stride_; }
  void solve_triangle();

  int count_ = 0, length_ = 0;
  std::size_t stride_ = 0;
  std::vector<double> q_, r_;  ///< column by column
  std::vector<double> rest_, parts_, weights_, y_;
};

}  // namespace clearway
