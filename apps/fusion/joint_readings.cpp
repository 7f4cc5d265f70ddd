#include "apps/fusion/joint_readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// How far a value is outside of the limits.
double excess(const Joint& joint, double value) {
  return std::max({joint.lower - value, value - joint.upper, 0.0});
}

std::string reading_of(const Joint& joint, double value) {
  const std::string unit = joint.kind == JointKind::revolute ? " rad" : " m";
  return "joint " + quote(joint.name) + " reads " + short_text(value) + unit + ", its limits are " +
         short_text(joint.lower) + " and " + short_text(joint.upper) + unit;
}

}  // namespace

bool is_possible(const Joint& joint, double value) {
  if (joint.kind == JointKind::revolute) return excess(joint, value) <= turn + 0.1;
  return excess(joint, value) == 0.0 || std::abs(value) <= std::max(1.0, 10.0 * (joint.upper - joint.lower));
}

void require_possible(const Joint& joint, double value, const std::string& where) {
  const bool turns = joint.kind == JointKind::revolute;
  if (is_possible(joint, value)) return;
  throw std::invalid_argument(
      where + ": " + reading_of(joint, value) +
      (turns ? ": expected radians; are these degrees?" : ": expected metres; are these millimetres?"));
}

std::optional<std::string> beyond_limits(const Joint& joint, double value) {
  const bool turns = joint.kind == JointKind::revolute;
  double least = excess(joint, value);
  if (turns && least > 0.0 && std::isfinite(least)) {
    // The turns that lead to the values on both sides of the limits' middle, which are the nearest to them.
    const double turns_off = (value - 0.5 * (joint.lower + joint.upper)) / turn;
    for (const double whole : {std::floor(turns_off), std::ceil(turns_off)})
      least = std::min(least, excess(joint, value - whole * turn));
  }
  if (least <= (turns ? 0.1 : 0.02)) return std::nullopt;
  return reading_of(joint, value);
}

}  // namespace clearway
