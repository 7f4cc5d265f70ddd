#include "planning/path/motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

void require_scale(const char* name, double scale) {
  if (scale > 0.0 && scale <= 1.0) return;
  throw std::invalid_argument(std::string(name) + " is " + short_text(scale) +
                              ", expected a number above 0, at most 1");
}

void require_above_zero(const char* name, double value) {
  if (std::isfinite(value) && value > 0.0) return;
  throw std::invalid_argument(std::string(name) + " is " + short_text(value) +
                              ", expected a finite number above 0");
}

/// d3q/dt3 between knots k and k + 1.
Eigen::VectorXd jerk_after(const Motion& motion, std::size_t k) {
  return (motion.accelerations[k + 1] - motion.accelerations[k]) / motion.period;
}

}  // namespace

RateLimits rate_limits(const Robot& robot, const MotionScales& scales) {
  require_scale("speed", scales.speed);
  require_scale("acceleration", scales.acceleration);
  require_scale("jerk", scales.jerk);
  require_above_zero("default_velocity", scales.default_velocity);
  require_above_zero("default_acceleration", scales.default_acceleration);
  require_above_zero("default_rise_time", scales.default_rise_time);
  const auto n = static_cast<Eigen::Index>(robot.dof());
  RateLimits limits{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const auto own = [](double value, double otherwise) { return value > 0.0 ? value : otherwise; };
    const double acceleration = own(joint.max_acceleration, scales.default_acceleration);
    limits.velocity[j] = scales.speed * own(joint.max_velocity, scales.default_velocity);
    limits.acceleration[j] = scales.acceleration * acceleration;
    limits.jerk[j] = scales.jerk * own(joint.max_jerk, acceleration / scales.default_rise_time);
  }
  return limits;
}

MotionState Motion::at(double time) const {
  const std::size_t last = positions.size() - 1;
  const double place = std::clamp(time / period, 0.0, static_cast<double>(last));
  const std::size_t k = std::min(static_cast<std::size_t>(place), last == 0 ? 0 : last - 1);
  if (last == 0)
    return {positions[0], velocities[0], accelerations[0], Eigen::VectorXd::Zero(positions[0].size())};
  const double t = (place - static_cast<double>(k)) * period;
  const Eigen::VectorXd jerk = jerk_after(*this, k);
  return {positions[k] + t * velocities[k] + (t * t / 2.0) * accelerations[k] + (t * t * t / 6.0) * jerk,
          velocities[k] + t * accelerations[k] + (t * t / 2.0) * jerk, accelerations[k] + t * jerk, jerk};
}

Motion spline_motion(const std::vector<Configuration>& control, double period) {
  Motion motion{period, {}, {}, {}};
  for (std::size_t k = 1; k + 1 < control.size(); ++k) {
    // Differences first: where the control points are equal the motion rests, bit for bit.
    const Eigen::VectorXd before = control[k] - control[k - 1], after = control[k + 1] - control[k];
    motion.positions.emplace_back(control[k] + (after - before) / 6.0);
    motion.velocities.emplace_back((before + after) / (2.0 * period));
    motion.accelerations.emplace_back((after - before) / (period * period));
  }
  return motion;
}

std::vector<Eigen::VectorXd> hermite_accelerations(const Motion& motion) {
  const std::size_t last = motion.positions.size() - 1;
  const double h = motion.period;
  std::vector<Eigen::VectorXd> accelerations;
  for (std::size_t k = 0; k < last; ++k)
    accelerations.emplace_back(6.0 / (h * h) * (motion.positions[k + 1] - motion.positions[k]) -
                               (4.0 * motion.velocities[k] + 2.0 * motion.velocities[k + 1]) / h);
  if (last == 0) return {Eigen::VectorXd::Zero(motion.positions[0].size())};
  accelerations.emplace_back((2.0 * motion.velocities[last - 1] + 4.0 * motion.velocities[last]) / h -
                             6.0 / (h * h) * (motion.positions[last] - motion.positions[last - 1]));
  return accelerations;
}

void append(Motion& motion, const Motion& next) {
  if (motion.empty()) {
    motion = next;
    return;
  }
  motion.positions.insert(motion.positions.end(), next.positions.begin() + 1, next.positions.end());
  motion.velocities.insert(motion.velocities.end(), next.velocities.begin() + 1, next.velocities.end());
  motion.accelerations.insert(motion.accelerations.end(), next.accelerations.begin() + 1,
                              next.accelerations.end());
}

void append_rest(Motion& motion, std::size_t periods) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(motion.positions.back().size());
  motion.positions.resize(motion.positions.size() + periods, motion.positions.back());
  motion.velocities.resize(motion.positions.size(), none);
  motion.accelerations.resize(motion.positions.size(), none);
}

Motion stretch_of(const Motion& motion, std::size_t first, std::size_t last) {
  const auto part = [&](const std::vector<Eigen::VectorXd>& values) {
    return std::vector<Eigen::VectorXd>(values.begin() + static_cast<std::ptrdiff_t>(first),
                                        values.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  };
  return {motion.period, part(motion.positions), part(motion.velocities), part(motion.accelerations)};
}

RateLimits greatest_rates(const Motion& motion) {
  if (motion.positions.empty()) return {};
  const Eigen::Index n = motion.positions.front().size();
  RateLimits rates{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  const auto raise = [](Eigen::VectorXd& greatest, const Eigen::VectorXd& values) {
    greatest = greatest.cwiseMax(values.cwiseAbs());
  };
  for (std::size_t k = 0; k < motion.positions.size(); ++k) {
    raise(rates.velocity, motion.velocities[k]);
    raise(rates.acceleration, motion.accelerations[k]);
    if (k + 1 == motion.positions.size()) break;
    const Eigen::VectorXd& a = motion.accelerations[k];
    const Eigen::VectorXd jerk = jerk_after(motion, k);
    raise(rates.jerk, jerk);
    for (Eigen::Index j = 0; j < n; ++j) {  // where the acceleration passes 0 the velocity is extreme
      if (a[j] * motion.accelerations[k + 1][j] >= 0.0) continue;
      const double there = motion.velocities[k][j] - 0.5 * a[j] * a[j] / jerk[j];
      rates.velocity[j] = std::max(rates.velocity[j], std::abs(there));
    }
  }
  return rates;
}

MotionShares shares_of(const RateLimits& rates, const RateLimits& limits) {
  return {rates.velocity.cwiseQuotient(limits.velocity).maxCoeff(),
          rates.acceleration.cwiseQuotient(limits.acceleration).maxCoeff(),
          rates.jerk.cwiseQuotient(limits.jerk).maxCoeff()};
}

}  // namespace clearway
