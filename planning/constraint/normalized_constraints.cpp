#include "planning/constraint/normalized_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "planning/geometry/four_lanes.hpp"

namespace clearway {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A constraint of unit length is violated beyond this, relative to the size of its terms.
constexpr double kViolated = 1e-12;
/// A point that violates a constraint beyond this is no solution, relative to the size of its terms.
constexpr double kLost = 1e-7;
/// Bounds of normalized constraints beyond this are out of reach.
constexpr double kOutOfReach = 1e100;

std::size_t place(int i) { return static_cast<std::size_t>(i); }

}  // namespace

void NormalizedConstraints::begin(int variables) {
  n_ = variables;
  m_ = ready_ = 0;
  lower_.assign(place(n_), -infinity);
  upper_.assign(place(n_), infinity);
}

void NormalizedConstraints::set_limits(std::span<const double> lower, std::span<const double> upper) {
  for (std::size_t j = 0; j < lower_.size(); ++j) {
    if (!(lower[j] <= upper[j]) || lower[j] > kOutOfReach || upper[j] < -kOutOfReach)
      throw std::invalid_argument("quadratic program: lower limit over upper limit, or NaN");
    lower_[j] = lower[j] < -kOutOfReach ? -infinity : lower[j];
    upper_[j] = upper[j] > kOutOfReach ? infinity : upper[j];
  }
}

void NormalizedConstraints::add(std::span<const double> normal, double bound) {
  if (!(bound > -infinity)) throw std::invalid_argument("quadratic program: a bound is NaN or -infinity");
  const int lane = m_ % lanes::width;
  double* block = nullptr;
  if (lane == 0) {
    const std::size_t size = place(m_) + lanes::width;
    if (bounds_.size() < size) {
      bounds_.resize(2 * size);
      demands_.resize(2 * size);
      lengths_.resize(2 * size);
    }
    if (normals_.size() < size * place(n_)) normals_.resize(2 * size * place(n_));
    block = normals_.data() + place(m_) * place(n_);
    std::fill_n(block, lanes::width * n_, 0.0);
    std::fill_n(bounds_.begin() + m_, lanes::width, infinity);
  } else {
    block = normals_.data() + place(m_ - lane) * place(n_);
  }
  for (int j = 0; j < n_; ++j) block[lanes::width * j + lane] = normal[place(j)];
  bounds_[place(m_)] = bound;
  ++m_;
}

void NormalizedConstraints::normalise() {
  while (ready_ < m_ && ready_ % lanes::width != 0) normalise_alone(ready_++);  // a block begun before
  for (; ready_ < m_; ready_ += lanes::width) {
    double* block = normals_.data() + place(ready_) * place(n_);
    lanes::Numbers squared;
    for (int j = 0; j < n_; ++j) {
      const lanes::Numbers column = lanes::load(block + lanes::width * j);
      squared = squared + column * column;
    }
    const int count = std::min(lanes::width, m_ - ready_);
    double inverse[lanes::width] = {};
    bool is_ordinary = true;
    for (int lane = 0; lane < count; ++lane) {
      const double length = std::sqrt(squared[lane]);
      const double bound = bounds_[place(ready_ + lane)] * (inverse[lane] = 1.0 / length);
      is_ordinary = is_ordinary && length > 1e-100 && length < 1e100 && std::abs(bound) <= kOutOfReach;
      lengths_[place(ready_ + lane)] = length;
    }
    if (!is_ordinary) {
      for (int lane = 0; lane < count; ++lane) normalise_alone(ready_ + lane);
      continue;
    }
    const lanes::Numbers factors = lanes::load(inverse);
    for (int j = 0; j < n_; ++j)
      lanes::store(block + lanes::width * j, factors * lanes::load(block + lanes::width * j));
    for (int lane = 0; lane < count; ++lane) {
      double& bound = bounds_[place(ready_ + lane)];
      bound *= inverse[lane];
      demands_[place(ready_ + lane)] = std::min(bound, 0.0);
    }
  }
  ready_ = m_;
}

/// A constraint of any scale. A constraint of zeros keeps its bound: 0 <= b.
void NormalizedConstraints::normalise_alone(int constraint) {
  const int lane = constraint % lanes::width;
  double* numbers = normals_.data() + place(constraint - lane) * place(n_) + lane;
  double most = 0.0, squared = 0.0;
  for (int j = 0; j < n_; ++j) most = std::max(most, std::abs(numbers[lanes::width * j]));
  for (int j = 0; most > 0.0 && j < n_; ++j) {
    const double part = numbers[lanes::width * j] / most;
    squared += part * part;
  }
  if (!(most <= 1e150) || std::isnan(squared))
    throw std::invalid_argument("quadratic program: a row holds NaN or a number beyond 1e150");
  for (int j = 0; j < n_; ++j) {
    if (std::isnan(numbers[lanes::width * j]))
      throw std::invalid_argument("quadratic program: a row holds NaN");
  }
  const double length = most > 0.0 ? most * std::sqrt(squared) : 1.0;
  double bound = bounds_[place(constraint)] / length;
  const bool is_out_of_reach = bound < -kOutOfReach;  // as good as 0 x <= -1
  if (is_out_of_reach) bound = -1.0;
  if (bound > kOutOfReach) bound = infinity;
  for (int j = 0; j < n_; ++j)
    numbers[lanes::width * j] = is_out_of_reach ? 0.0 : numbers[lanes::width * j] / length;
  bounds_[place(constraint)] = bound;
  demands_[place(constraint)] = std::min(bound, 0.0);
  lengths_[place(constraint)] = length;
}

Violation NormalizedConstraints::most_violated(const double* x, double size,
                                               const std::vector<unsigned char>& is_out) const {
  lanes::LeastSoFar constraints{lanes::all(infinity), {}};
  const double* column = normals_.data();
  for (int i = 0; i < m_; i += lanes::width) {
    const lanes::Numbers bound = lanes::load(bounds_.data() + i);
    lanes::Numbers slack = bound;
    for (int j = 0; j < n_; ++j, column += lanes::width) slack = slack - x[j] * lanes::load(column);
    constraints.look_at(slack + kViolated * lanes::absolute(bound), i);
  }
  const double tolerance = kViolated * size;
  double lowest = -tolerance;
  int worst = -1;
  for (int lane = 0; lane < lanes::width; ++lane) {
    const int constraint = static_cast<int>(constraints.where[lane]);
    const double least = constraints.least[lane];
    if (least < lowest || (worst >= 0 && least == lowest && constraint < worst)) {
      lowest = least;
      worst = constraint;
    }
  }
  for (int j = 0; j < n_; ++j) {
    const double above = upper_[place(j)] - x[j] + kViolated * std::abs(upper_[place(j)]);
    const double below = x[j] - lower_[place(j)] + kViolated * std::abs(lower_[place(j)]);
    if (above < lowest) {
      lowest = above;
      worst = m_ + j;
    }
    if (below < lowest) {
      lowest = below;
      worst = m_ + n_ + j;
    }
  }
  if (worst < 0) return {};
  const Violation of_all{worst, kViolated * std::abs(bound(worst)) - lowest};
  if (is_out[place(worst)] == 0) return of_all;
  Violation counted = one_by_one(x, tolerance, is_out);
  counted.is_lost = !(of_all.depth <= kLost * (size + std::abs(bound(worst))));
  return counted;
}

/// The same where one that is out seems to be violated by rounding.
Violation NormalizedConstraints::one_by_one(const double* x, double tolerance,
                                            const std::vector<unsigned char>& is_out) const {
  Violation worst;
  for (int i = 0; i < size(); ++i) {
    if (is_out[place(i)] != 0) continue;
    const double depth = value(i, x) - bound(i);
    if (depth > tolerance + kViolated * std::abs(bound(i)) && depth > worst.depth) worst = {i, depth};
  }
  return worst;
}

double NormalizedConstraints::farthest_within_limits() const {
  double squared = 0.0;
  for (int j = 0; j < n_; ++j) {
    const double most = std::max(std::abs(lower_[place(j)]), std::abs(upper_[place(j)]));
    squared += most * most;
  }
  return std::sqrt(squared);
}

double NormalizedConstraints::bound(int constraint) const {
  if (constraint < m_) return bounds_[place(constraint)];
  if (constraint < m_ + n_) return upper_[place(constraint - m_)];
  return -lower_[place(constraint - m_ - n_)];
}

double NormalizedConstraints::value(int constraint, const double* x) const {
  if (constraint >= m_ + n_) return -x[constraint - m_ - n_];
  if (constraint >= m_) return x[constraint - m_];
  const int lane = constraint % lanes::width;
  const double* numbers = normals_.data() + place(constraint - lane) * place(n_) + lane;
  double sum = 0.0;
  for (int j = 0; j < n_; ++j) sum += numbers[lanes::width * j] * x[j];
  return sum;
}

double NormalizedConstraints::length(int constraint) const {
  return constraint < m_ ? lengths_[place(constraint)] : 1.0;
}

void NormalizedConstraints::load(int constraint, double* normal) const {
  std::fill_n(normal, lanes::padded(n_), 0.0);
  if (constraint >= m_) {
    const int limit = constraint - m_;
    normal[limit % n_] = limit < n_ ? 1.0 : -1.0;
    return;
  }
  const int lane = constraint % lanes::width;
  const double* numbers = normals_.data() + place(constraint - lane) * place(n_) + lane;
  for (int j = 0; j < n_; ++j) normal[j] = numbers[lanes::width * j];
}

}  // namespace clearway
