// The same active-set method written with dense matrices that are made and factored anew at each step, as
// a textbook has it.

#include "apps/bench/peers/dense_program.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace clearway::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A normal whose part outside the span of the active normals is shorter than this counts as dependent.
constexpr double kDependent = 1e-10;
/// A constraint of unit length is violated beyond this, relative to the size of its terms.
constexpr double kViolated = 1e-12;

/// One constraint a^T x <= b with ||a|| = 1; `length` is what it was divided by.
struct Constraints {
  MatrixXd normals;  ///< n x count, one per column
  VectorXd bounds;
  VectorXd lengths;
  std::vector<int> names;  ///< number of the constraint as the caller counts
};

/// All finite constraints, scaled to unit normals. Constraints of length 0 stay as they are (0 <= b).
Constraints normalised(const QuadraticProgram& p) {
  const Index n = p.target.size(), m = p.matrix.rows();
  Constraints c;
  c.normals.resize(n, m + 2 * n);
  c.bounds.resize(m + 2 * n);
  c.lengths.resize(m + 2 * n);
  Index count = 0;
  const auto add = [&](const auto& normal, double bound, Index name) {
    if (!std::isfinite(bound)) return;
    const double length = normal.stableNorm();
    c.lengths[count] = length > 0.0 ? length : 1.0;
    c.normals.col(count) = normal / c.lengths[count];
    c.bounds[count] = bound / c.lengths[count];
    c.names.push_back(static_cast<int>(name));
    ++count;
  };
  for (Index i = 0; i < m; ++i) add(p.matrix.row(i).transpose(), p.bounds[i], i);
  for (Index j = 0; p.upper.size() && j < n; ++j) add(VectorXd(VectorXd::Unit(n, j)), p.upper[j], m + j);
  for (Index j = 0; p.lower.size() && j < n; ++j)
    add(VectorXd(-VectorXd::Unit(n, j)), -p.lower[j], m + n + j);
  c.normals.conservativeResize(Eigen::NoChange, count);
  c.bounds.conservativeResize(count);
  return c;
}

/// The active set of Goldfarb and Idnani: constraints held with equality and their multipliers.
class DualActiveSet {
 public:
  DualActiveSet(const VectorXd& target, const Constraints& constraints)
      : target_(target), c_(constraints), x_(target) {}

  /// The most violated constraint, -1 when there is none. Ties: the first.
  int most_violated() const {
    int worst = -1;
    double depth = 0.0;
    const VectorXd slack = c_.bounds - c_.normals.transpose() * x_;
    const double size = x_.norm() + target_.norm();
    for (Index i = 0; i < slack.size(); ++i) {
      const bool is_violated = slack[i] < -kViolated * (std::abs(c_.bounds[i]) + size);
      if (is_violated && slack[i] < -depth && !is_active(static_cast<int>(i))) {
        depth = -slack[i];
        worst = static_cast<int>(i);
      }
    }
    return worst;
  }

  /// Adds constraint `p`, dropping those that block it. False when it contradicts the active ones.
  bool add(int p) {
    double multiplier = 0.0;
    for (;;) {
      const VectorXd a = c_.normals.col(p);
      const VectorXd r = least_squares(a);
      VectorXd z = a;
      if (!active_.empty()) z -= normals() * r;
      const double reach = z.squaredNorm() > kDependent * kDependent
                               ? (a.dot(x_) - c_.bounds[p]) / z.dot(a)
                               : std::numeric_limits<double>::infinity();
      double drop_at = std::numeric_limits<double>::infinity();
      Index dropped = -1;
      for (Index i = 0; i < r.size(); ++i) {
        if (r[i] > 1e-14 && multipliers_[i] / r[i] < drop_at) {
          drop_at = multipliers_[i] / r[i];
          dropped = i;
        }
      }
      const double step = std::min(reach, drop_at);
      if (std::isinf(step)) return certify(p, r);
      ++iterations_;
      multiplier += step;
      for (Index i = 0; i < r.size(); ++i) multipliers_[i] = std::max(0.0, multipliers_[i] - step * r[i]);
      if (std::isfinite(reach)) x_ -= step * z;
      if (reach <= drop_at) {
        active_.push_back(p);
        multipliers_.push_back(multiplier);
        polish();
        return true;
      }
      active_.erase(active_.begin() + dropped);
      multipliers_.erase(multipliers_.begin() + dropped);
    }
  }

  int iterations() const { return iterations_; }
  const VectorXd& x() const { return x_; }

  /// Multipliers (or Farkas weights) in the caller's numbering.
  VectorXd named(const std::vector<double>& weights, Index count) const {
    VectorXd all = VectorXd::Zero(count);
    for (std::size_t i = 0; i < active_.size(); ++i)
      all[c_.names[active_[i]]] = weights[i] / c_.lengths[active_[i]];
    return all;
  }
  const std::vector<double>& multipliers() const { return multipliers_; }
  const std::vector<double>& farkas() const { return farkas_; }

 private:
  bool is_active(int p) const { return std::find(active_.begin(), active_.end(), p) != active_.end(); }

  MatrixXd normals() const {
    MatrixXd columns(target_.size(), static_cast<Index>(active_.size()));
    for (std::size_t i = 0; i < active_.size(); ++i)
      columns.col(static_cast<Index>(i)) = c_.normals.col(active_[i]);
    return columns;
  }

  VectorXd least_squares(const VectorXd& a) const {
    if (active_.empty()) return VectorXd(0);
    return Eigen::HouseholderQR<MatrixXd>(normals()).solve(a);
  }

  /// x and the multipliers anew from the active set alone, so that errors do not add up over the steps.
  void polish() {
    const MatrixXd columns = normals();
    const Index count = columns.cols();
    const Eigen::HouseholderQR<MatrixXd> qr(columns);
    const auto R = qr.matrixQR().topRows(count).template triangularView<Eigen::Upper>();
    VectorXd b(count);
    for (Index i = 0; i < count; ++i) b[i] = c_.bounds[active_[static_cast<std::size_t>(i)]];
    // x = target - N u with N^T x = b:  R^T R u = N^T target - b.
    const VectorXd half = R.transpose().solve(columns.transpose() * target_ - b);
    const VectorXd u = R.solve(half);
    if (!u.allFinite() || u.minCoeff() < -1e-9 * (1.0 + u.cwiseAbs().maxCoeff())) return;  // keep the update
    for (Index i = 0; i < count; ++i) multipliers_[static_cast<std::size_t>(i)] = std::max(0.0, u[i]);
    x_ = target_ - columns * u;
  }

  /// a_p = sum r_i a_i with r <= 0: the weights -r of the active constraints and 1 of p sum to zero.
  bool certify(int p, const VectorXd& r) {
    farkas_.clear();
    for (const double value : r) farkas_.push_back(std::max(0.0, -value));
    active_.push_back(p);
    farkas_.push_back(1.0);
    return false;
  }

  const VectorXd& target_;
  const Constraints& c_;
  VectorXd x_;
  std::vector<int> active_;
  std::vector<double> multipliers_, farkas_;
  int iterations_ = 0;
};

}  // namespace

QuadraticSolution solve_densely(const QuadraticProgram& program) {
  const Constraints constraints = normalised(program);
  const Index count = program.matrix.rows() + 2 * program.target.size();
  DualActiveSet set(program.target, constraints);
  QuadraticSolution result;
  // Every pass raises the dual value, so no active set returns; the cap only guards against rounding.
  const int cap = 100 + 20 * static_cast<int>(constraints.bounds.size() + program.target.size());
  int worst = set.most_violated();
  while (worst >= 0 && set.iterations() < cap) {
    if (!set.add(worst)) {
      result.conflicting = constraints.names[static_cast<std::size_t>(worst)];
      result.multipliers = set.named(set.farkas(), count);
      break;
    }
    worst = set.most_violated();
  }
  result.feasible = worst < 0;
  result.iterations = set.iterations();
  result.x = set.x();
  if (result.conflicting < 0) result.multipliers = set.named(set.multipliers(), count);
  if (!result.feasible && result.conflicting < 0)
    result.conflicting = constraints.names[static_cast<std::size_t>(worst)];
  return result;
}

}  // namespace clearway::bench
