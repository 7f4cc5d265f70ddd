#include "planning/path/bezier.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

constexpr double close_enough = 1e-12;  ///< share of the largest control value
constexpr double narrowest = 0x1p-50;   ///< share of the duration

/// One component on a part of its time.
struct Part {
  std::vector<double> control;
  double from = 0.0, width = 1.0;
};

/// Cuts control points in halves: `second` becomes those of the second half, `first` those of the first.
template <class Value>
void cut(std::vector<Value>& second, std::vector<Value>& first) {
  first.clear();
  for (std::size_t left = second.size(); left > 0; --left) {
    first.push_back(second.front());
    for (std::size_t i = 0; i + 1 < left; ++i) second[i] = 0.5 * (second[i] + second[i + 1]);
  }
}

/// Branch and bound: parts whose hull holds nothing greater than what was found are left.
BezierPeak greatest(Part whole) {
  double scale = 0.0;
  for (const double value : whole.control) scale = std::max(scale, std::abs(value));
  BezierPeak best{whole.control.front(), 0.0};
  if (whole.control.back() > best.value) best = {whole.control.back(), 1.0};
  std::vector<Part> open{std::move(whole)};
  while (!open.empty()) {
    Part second = std::move(open.back());
    open.pop_back();
    const double bound = *std::max_element(second.control.begin(), second.control.end());
    if (!(bound > best.value + close_enough * scale) || second.width < narrowest) continue;
    Part first{{}, second.from, second.width / 2.0};
    cut(second.control, first.control);
    second.from += first.width;
    second.width = first.width;
    if (second.control.front() > best.value) best = {second.control.front(), second.from};
    open.push_back(std::move(first));
    open.push_back(std::move(second));
  }
  return best;
}

Part component(const Bezier& curve, Eigen::Index j, double sign) {
  Part part;
  for (const Eigen::VectorXd& point : curve.control) part.control.push_back(sign * point[j]);
  return part;
}

}  // namespace

Eigen::VectorXd value_at(const Bezier& curve, double share) {
  std::vector<Eigen::VectorXd> points = curve.control;
  for (std::size_t left = points.size() - 1; left > 0; --left)
    for (std::size_t i = 0; i < left; ++i) points[i] += share * (points[i + 1] - points[i]);
  return points.front();
}

Bezier linear_between(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double duration) {
  return {{from, to}, duration};
}

Bezier cubic_between(const BezierEnd& from, const BezierEnd& to, double duration) {
  const double h = duration;
  return {{from.position, from.position + h / 3.0 * from.velocity, to.position - h / 3.0 * to.velocity,
           to.position},
          h};
}

Bezier quintic_between(const BezierEnd& from, const BezierEnd& to, double duration) {
  const double h = duration;
  return {{from.position, from.position + h / 5.0 * from.velocity,
           from.position + 2.0 * h / 5.0 * from.velocity + h * h / 20.0 * from.acceleration,
           to.position - 2.0 * h / 5.0 * to.velocity + h * h / 20.0 * to.acceleration,
           to.position - h / 5.0 * to.velocity, to.position},
          h};
}

std::pair<Bezier, Bezier> halves(const Bezier& curve) {
  Bezier first{{}, curve.duration / 2.0}, second{curve.control, curve.duration / 2.0};
  cut(second.control, first.control);
  return {std::move(first), std::move(second)};
}

Bezier derivative(const Bezier& curve) {
  if (curve.control.size() == 1)
    return {{Eigen::VectorXd::Zero(curve.control.front().size())}, curve.duration};
  const double degree = static_cast<double>(curve.control.size() - 1);
  Bezier rate{{}, curve.duration};
  for (std::size_t i = 0; i + 1 < curve.control.size(); ++i)
    rate.control.emplace_back(degree / curve.duration * (curve.control[i + 1] - curve.control[i]));
  return rate;
}

BezierPeak highest(const Bezier& curve, Eigen::Index j) { return greatest(component(curve, j, 1.0)); }

BezierPeak lowest(const Bezier& curve, Eigen::Index j) {
  const BezierPeak found = greatest(component(curve, j, -1.0));
  return {-found.value, found.share};
}

BezierPeak peak(const Bezier& curve, Eigen::Index j) {
  const BezierPeak high = highest(curve, j), low = lowest(curve, j);
  return std::abs(low.value) > std::abs(high.value) ? low : high;
}

}  // namespace clearway
