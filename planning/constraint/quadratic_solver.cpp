#include "planning/constraint/quadratic_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "planning/geometry/four_lanes.hpp"

namespace clearway {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// A normal whose part outside the span of the active normals is no longer than this counts as dependent.
constexpr double kDependent = 1e-10;
/// A contradiction counts when it is larger than this, relative to the terms that it is the sum of.
constexpr double kRounding = 1e-13;
/// Weights below this are taken as 0.
constexpr double kNoWeight = 1e-14;
/// In is_out_: found to hold within rounding, given the active constraints of that time.
constexpr unsigned char kSetAside = 2;

}  // namespace

void QuadraticSolver::begin(int variables) {
  constraints_.begin(variables);
  normals_.begin(variables);
  const auto length = static_cast<std::size_t>(lanes::padded(variables));
  target_.assign(length, 0.0);
  for (std::vector<double>* vector : {&x_, &normal_, &trial_}) vector->resize(length);
}

void QuadraticSolver::set_target(std::span<const double> target) {
  for (const double value : target) {
    if (!(std::abs(value) <= 1e100))
      throw std::invalid_argument("quadratic program: the target holds NaN or a number beyond 1e100");
  }
  std::copy(target.begin(), target.end(), target_.begin());
}

void QuadraticSolver::set_limits(std::span<const double> lower, std::span<const double> upper) {
  constraints_.set_limits(lower, upper);
}

void QuadraticSolver::add_constraint(std::span<const double> normal, double bound) {
  constraints_.add(normal, bound);
}

/// Takes up a constraint, letting go those that block it.
QuadraticSolver::Addition QuadraticSolver::add(const Violation& violation) {
  const int p = violation.constraint, length = static_cast<int>(x_.size());
  constraints_.load(p, normal_.data());
  double multiplier = 0.0, depth = violation.depth;
  for (;;) {
    const double rest = normals_.split(normal_.data());
    const double* weights = normals_.weights();
    const bool is_dependent = !(rest > kDependent) || normals_.count() == variables();
    const double reach = is_dependent ? unbounded : depth / (rest * rest);
    double drop_at = unbounded;
    int dropped = -1;
    for (int i = 0; i < normals_.count(); ++i) {
      const double held = active_multipliers_[static_cast<std::size_t>(i)];
      if (weights[i] <= kNoWeight || held >= drop_at * weights[i]) continue;
      drop_at = held / weights[i];
      dropped = i;
    }
    if (is_dependent && dropped < 0)
      return is_real({p, depth}, rest) ? Addition::contradicts : Addition::within_rounding;
    ++iterations_;
    const double step = std::min(reach, drop_at);
    multiplier += step;
    for (int i = 0; i < normals_.count(); ++i) {
      double& held = active_multipliers_[static_cast<std::size_t>(i)];
      held = std::max(0.0, held - step * weights[i]);
    }
    if (!is_dependent) lanes::take_off(x_.data(), step, normals_.rest(), length);
    if (reach <= drop_at) {
      normals_.append(rest);
      active_.push_back(p);
      active_multipliers_.push_back(multiplier);
      active_bounds_.push_back(constraints_.bound(p));
      is_out_[static_cast<std::size_t>(p)] = 1;
      return Addition::added;
    }
    drop(dropped);
    depth = lanes::dot(normal_.data(), x_.data(), length) - constraints_.bound(p);
  }
}

/// Whether a normal that depends on the active ones is violated by more than the rounding of what says so.
bool QuadraticSolver::is_real(const Violation& violation, double rest) const {
  const double size = std::sqrt(lanes::dot(x_.data(), x_.data(), static_cast<int>(x_.size())));
  double terms = std::abs(constraints_.bound(violation.constraint)) + size;
  for (int i = 0; i < normals_.count(); ++i) {
    terms += std::abs(normals_.weights()[i]) * (std::abs(active_bounds_[static_cast<std::size_t>(i)]) + size);
  }
  return violation.depth > kRounding * terms + 2.0 * rest * size;
}

void QuadraticSolver::drop(int which) {
  std::replace(is_out_.begin(), is_out_.end(), kSetAside, static_cast<unsigned char>(0));
  is_out_[static_cast<std::size_t>(active_[static_cast<std::size_t>(which)])] = 0;
  normals_.drop(which);
  active_.erase(active_.begin() + which);
  active_multipliers_.erase(active_multipliers_.begin() + which);
  active_bounds_.erase(active_bounds_.begin() + which);
}

/// x and the multipliers anew from the active set alone, so that errors do not add up over the steps.
void QuadraticSolver::polish() {
  normals_.project(target_.data(), active_bounds_.data(), trial_.data());
  const double* weights = normals_.weights();
  double least = 0.0, most = 0.0;
  for (int i = 0; i < normals_.count(); ++i) {
    least = std::min(least, weights[i]);
    most = std::max(most, std::abs(weights[i]));
  }
  if (!(most < unbounded) || least < -1e-9 * (1.0 + most)) return;  // keep what the steps came to
  for (int i = 0; i < normals_.count(); ++i)
    active_multipliers_[static_cast<std::size_t>(i)] = std::max(0.0, weights[i]);
  x_.swap(trial_);
}

bool QuadraticSolver::run() {
  const int length = static_cast<int>(x_.size());
  std::copy(target_.begin(), target_.end(), x_.begin());
  target_size_ = std::sqrt(lanes::dot(target_.data(), target_.data(), length));
  normals_.clear();
  active_.clear();
  active_multipliers_.clear();
  active_bounds_.clear();
  const auto constraints = static_cast<std::size_t>(constraints_.size());
  is_out_.assign(constraints, 0);
  multipliers_.assign(constraints, 0.0);
  // Every pass raises the dual value, so no active set returns; the cap only guards against rounding.
  const int cap = iterations_ + 100 + 20 * constraints_.size();
  // x is the point nearest to the target that the active constraints allow, so no feasible one is nearer.
  const double out_of_reach = 4.0 * target_size_ + 2.0 * constraints_.farthest_within_limits();
  for (bool is_polished = true;;) {
    const double size = target_size_ + std::sqrt(lanes::dot(x_.data(), x_.data(), length));
    if (size > out_of_reach) {
      report_proof_by_limits();
      return false;
    }
    const Violation worst = constraints_.most_violated(x_.data(), size, is_out_);
    if (worst.constraint < 0) {
      if (is_polished && worst.is_lost) return false;
      if (is_polished) break;
      polish();
      is_polished = true;
      continue;
    }
    const Addition addition = add(worst);
    is_polished = false;
    if (addition == Addition::within_rounding)
      is_out_[static_cast<std::size_t>(worst.constraint)] = kSetAside;
    if (addition == Addition::contradicts) {
      report_proof(worst.constraint);
      return false;
    }
    if (iterations_ >= cap) return false;  // no proof: the multipliers stay 0
  }
  for (std::size_t i = 0; i < active_.size(); ++i) {
    multipliers_[static_cast<std::size_t>(active_[i])] =
        active_multipliers_[i] / constraints_.length(active_[i]);
  }
  return true;
}

/// The normal of `last` is a sum of active ones with weights <= 0: those and 1 for itself sum to zero.
void QuadraticSolver::report_proof(int last) {
  if (conflicting_ < 0) conflicting_ = last;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    multipliers_[static_cast<std::size_t>(active_[i])] =
        std::max(0.0, -normals_.weights()[i]) / constraints_.length(active_[i]);
  }
  multipliers_[static_cast<std::size_t>(last)] = 1.0 / constraints_.length(last);
}

/// The active constraints, y a x <= y b with y the multipliers, ask for more along their sum, target - x,
/// than the limits leave: those and the limits that cancel that sum.
void QuadraticSolver::report_proof_by_limits() {
  if (conflicting_ < 0) conflicting_ = active_.back();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    multipliers_[static_cast<std::size_t>(active_[i])] =
        active_multipliers_[i] / constraints_.length(active_[i]);
  }
  for (int j = 0; j < variables(); ++j) {
    const auto place = static_cast<std::size_t>(j);
    const double sum = target_[place] - x_[place];
    const int limit = constraints_.inequalities() + (sum > 0.0 ? variables() : 0) + j;
    multipliers_[static_cast<std::size_t>(limit)] += std::abs(sum);
  }
}

bool QuadraticSolver::solve() {
  constraints_.normalise();
  shares_.assign(static_cast<std::size_t>(constraints_.inequalities()), 1.0);
  for (int i = 0; i < constraints_.inequalities(); ++i) {  // what solve_relaxed may have lowered
    if (constraints_.demand(i) < 0.0) constraints_.lower_demand(i, 1.0);
  }
  conflicting_ = -1;
  iterations_ = 0;
  return run();
}

/// Ends the contradiction that multipliers() reports: the sum of y_i s_i |b_i| over the demands that take
/// part must not exceed what the other constraints of the proof leave. False when no demand takes part.
bool QuadraticSolver::lower_shares() {
  const auto weight = [&](int i) {  // of the normalized constraint
    return multipliers_[static_cast<std::size_t>(i)] * constraints_.length(i);
  };
  const auto takes_part = [&](int i) { return constraints_.demand(i) < 0.0 && weight(i) > 0.0; };
  double room = 0.0;
  for (int i = 0; i < constraints_.size(); ++i) {
    const bool is_demand = i < constraints_.inequalities() && constraints_.demand(i) < 0.0;
    if (!is_demand && weight(i) > 0.0) room += weight(i) * constraints_.bound(i);
  }
  double cap = -1.0;  // grows: demands whose share is smaller leave more to the others
  for (int pass = 0; pass <= constraints_.inequalities(); ++pass) {
    double left = room, open = 0.0;
    for (int i = 0; i < constraints_.inequalities(); ++i) {
      if (!takes_part(i)) continue;
      const double share = shares_[static_cast<std::size_t>(i)];
      (share <= cap ? left : open) += weight(i) * constraints_.demand(i) * (share <= cap ? share : -1.0);
    }
    const double next = open > 0.0 ? std::max(0.0, left / open) : cap;
    if (next <= cap) break;
    cap = next;
  }
  bool has_changed = false;
  for (int i = 0; i < constraints_.inequalities(); ++i) {
    double& share = shares_[static_cast<std::size_t>(i)];
    if (!takes_part(i) || share <= cap) continue;
    share = cap;
    constraints_.lower_demand(i, share);
    has_changed = true;
  }
  return has_changed;
}

bool QuadraticSolver::solve_relaxed() {
  bool is_feasible = solve();
  for (int pass = 0; !is_feasible && pass < constraints_.inequalities() + 50 && lower_shares(); ++pass)
    is_feasible = run();
  if (is_feasible) return true;
  for (int i = 0; i < constraints_.inequalities(); ++i) {  // by rounding alone: nothing approaches
    if (constraints_.demand(i) >= 0.0) continue;
    shares_[static_cast<std::size_t>(i)] = 0.0;
    constraints_.lower_demand(i, 0.0);
  }
  return run();
}

double QuadraticSolver::smallest_share() const {
  return shares_.empty() ? 1.0 : *std::min_element(shares_.begin(), shares_.end());
}

}  // namespace clearway
