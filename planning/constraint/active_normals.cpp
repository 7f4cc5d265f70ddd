#include "planning/constraint/active_normals.hpp"

#include <algorithm>
#include <cmath>

#include "planning/geometry/four_lanes.hpp"

namespace clearway {

void ActiveNormals::begin(int variables) {
  count_ = 0;
  length_ = lanes::padded(variables);
  stride_ = static_cast<std::size_t>(length_);
  q_.resize(stride_ * stride_);
  r_.resize(stride_ * stride_);
  for (std::vector<double>* vector : {&rest_, &parts_, &weights_, &y_}) vector->resize(stride_);
}

double ActiveNormals::split(const double* normal) {
  std::copy_n(normal, length_, rest_.data());
  std::fill(parts_.begin(), parts_.end(), 0.0);
  double squared = 1.0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < count_; ++i) {
      const double part = lanes::dot(column(i), rest_.data(), length_);
      parts_[static_cast<std::size_t>(i)] += part;
      lanes::take_off(rest_.data(), part, column(i), length_);
    }
    squared = lanes::dot(rest_.data(), rest_.data(), length_);
    if (squared > 0.25) break;  // little was taken off, so that rounding is no part of what is left
  }
  weights_ = parts_;
  solve_triangle();
  return std::sqrt(squared);
}

/// weights = R^-1 weights
void ActiveNormals::solve_triangle() {
  for (int i = count_ - 1; i >= 0; --i) {
    const double weight = weights_[static_cast<std::size_t>(i)] / factors(i)[i];
    for (int j = 0; j < i; ++j) weights_[static_cast<std::size_t>(j)] -= weight * factors(i)[j];
    weights_[static_cast<std::size_t>(i)] = weight;
  }
}

void ActiveNormals::append(double length_of_rest) {
  for (int j = 0; j < length_; ++j) column(count_)[j] = rest_[static_cast<std::size_t>(j)] / length_of_rest;
  std::copy_n(parts_.data(), count_, factors(count_));
  factors(count_)[count_] = length_of_rest;
  ++count_;
}

void ActiveNormals::drop(int which) {
  --count_;
  for (int i = which; i < count_; ++i) std::copy_n(factors(i + 1), i + 2, factors(i));
  for (int i = which; i < count_; ++i) {  // rows i and i + 1, until R is a triangle again
    const double a = factors(i)[i], b = factors(i)[i + 1];
    const double length = std::sqrt(a * a + b * b);
    const double c = a / length, s = b / length;
    factors(i)[i] = length;
    for (int k = i + 1; k < count_; ++k) {
      const double first = factors(k)[i], second = factors(k)[i + 1];
      factors(k)[i] = c * first + s * second;
      factors(k)[i + 1] = c * second - s * first;
    }
    for (int j = 0; j < length_; j += lanes::width) {
      const lanes::Numbers first = lanes::load(column(i) + j), second = lanes::load(column(i + 1) + j);
      lanes::store(column(i) + j, c * first + s * second);
      lanes::store(column(i + 1) + j, c * second - s * first);
    }
  }
}

/// R' y = bounds,  x = target - Q (Q' target - y),  R weights = Q' target - y.
void ActiveNormals::project(const double* target, const double* bounds, double* x) {
  std::copy_n(target, length_, x);
  for (int i = 0; i < count_; ++i) {
    double value = bounds[i];
    for (int j = 0; j < i; ++j) value -= factors(i)[j] * y_[static_cast<std::size_t>(j)];
    y_[static_cast<std::size_t>(i)] = value / factors(i)[i];
    const double off = lanes::dot(column(i), target, length_) - y_[static_cast<std::size_t>(i)];
    weights_[static_cast<std::size_t>(i)] = off;
    lanes::take_off(x, off, column(i), length_);
  }
  solve_triangle();
}

}  // namespace clearway
