#include "planning/gate/motion_chunk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/require.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {
namespace {

/// What rounding may add to a joint's limit of rate, as a share of it: of times, which lose digits when they
/// count from 1970, and of positions, which had single precision where they were learned.
double rate_rounding(const MotionChunk& chunk, std::size_t i, Eigen::Index joint, double limit) {
  constexpr double least = 1e-9, most = 1e-3, of_time = 0x1p-52, of_position = 0x1p-24;
  const double times = std::abs(chunk.times[i]) + std::abs(chunk.times[i + 1]);
  const double places = std::abs(chunk.positions[i][joint]) + std::abs(chunk.positions[i + 1][joint]);
  const double lasts = chunk.times[i + 1] - chunk.times[i];
  return std::min(most, least + (of_time * times + of_position * places / limit) / lasts);
}

std::string times_name(std::size_t index) { return "times[" + std::to_string(index) + "]"; }
std::string positions_name(std::size_t index) { return "positions[" + std::to_string(index) + "]"; }

std::string unit_of(const Joint& joint) { return joint.kind == JointKind::revolute ? " rad" : " m"; }

ChunkFault size_fault(const MotionChunk& chunk, const Robot& robot) {
  const std::size_t count = chunk.positions.size();
  const std::string expected =
      ", expected " + std::to_string(MotionChunk::fewest) + " to " + std::to_string(MotionChunk::most);
  if (count < MotionChunk::fewest)
    return {GateReason::too_short, "the chunk has " + counted(count, "configuration") + expected};
  if (count > MotionChunk::most)
    return {GateReason::too_long, "the chunk has " + counted(count, "configuration") + expected};
  if (chunk.times.size() != count)
    return {GateReason::wrong_size, "the chunk has " + counted(chunk.times.size(), "time") + " for " +
                                        counted(count, "configuration") + ", expected one for each"};
  for (std::size_t i = 0; i < count; ++i) {
    const auto size = static_cast<std::size_t>(chunk.positions[i].size());
    if (size != robot.dof())
      return {GateReason::wrong_size, positions_name(i) + " has " + counted(size, "value") + ", expected " +
                                          std::to_string(robot.dof()) + ", one for each joint of " +
                                          robot.name};
  }
  return {};
}

ChunkFault finite_fault(const MotionChunk& chunk) {
  for (std::size_t i = 0; i < chunk.times.size(); ++i) {
    if (!std::isfinite(chunk.times[i]))
      return {GateReason::not_finite, times_name(i) + " is not finite, expected a number"};
    for (Eigen::Index j = 0; j < chunk.positions[i].size(); ++j) {
      if (!std::isfinite(chunk.positions[i][j]))
        return {GateReason::not_finite,
                positions_name(i) + "[" + std::to_string(j) + "] is not finite, expected a number"};
    }
  }
  return {};
}

ChunkFault time_fault(const std::vector<double>& times, double max_duration) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    return {GateReason::time_order, times_name(i) + " is " + to_text(times[i]) + " s, not after " +
                                        times_name(i - 1) + ", which is " + to_text(times[i - 1]) + " s"};
  }
  const double duration = times.back() - times.front();
  if (duration <= max_duration) return {};
  return {GateReason::lasts_too_long, "the chunk lasts " + short_text(duration) + " s, expected at most " +
                                          short_text(max_duration) + " s"};
}

ChunkFault limit_fault(const MotionChunk& chunk, const Robot& robot) {
  for (std::size_t i = 0; i < chunk.positions.size(); ++i) {
    const Configuration& q = chunk.positions[i];
    if (const std::string violation = limit_violation(robot, q); !violation.empty())
      return {GateReason::joint_limit, positions_name(i) + ": " + violation};
  }
  return {};
}

/// An encoder that wraps within a chunk.
std::string wrap_hint(const MotionChunk& chunk, std::size_t i, std::size_t j, const Robot& robot) {
  const auto at = static_cast<Eigen::Index>(j);
  const double step = chunk.positions[i + 1][at] - chunk.positions[i][at];
  if (!is_endless(robot.joints[j]) || std::abs(step) <= std::numbers::pi) return {};
  return "; within a chunk its angle is expected to go on where an encoder wraps";
}

ChunkFault velocity_fault(const MotionChunk& chunk, const Robot& robot, const JointLimits& limits) {
  for (std::size_t i = 0; i + 1 < chunk.positions.size(); ++i) {
    const Eigen::VectorXd velocity = edge_velocity(chunk, i);
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double rate = std::abs(velocity[static_cast<Eigen::Index>(j)]);
      const double limit = limits.max_velocity[static_cast<Eigen::Index>(j)];
      if (rate <= limit * (1.0 + rate_rounding(chunk, i, static_cast<Eigen::Index>(j), limit))) continue;
      const std::string unit = unit_of(robot.joints[j]) + "/s";
      return {GateReason::velocity_limit, "from " + positions_name(i) + " to " + positions_name(i + 1) +
                                              " joint " + shortened(robot.joints[j].name) + " moves at " +
                                              short_text(rate) + unit + ", above its limit " +
                                              short_text(limit) + unit + wrap_hint(chunk, i, j, robot)};
    }
  }
  return {};
}

/// One value for each joint.
void require_above_zero(const std::vector<double>& list, const char* name) {
  for (const double value : list)
    require(std::isfinite(value) && value > 0.0,
            std::string("gate: ") + name + " is " + short_text(value) + ", expected a finite number above 0");
}

Eigen::VectorXd for_each_joint(const std::vector<double>& list, const Robot& robot, const char* name) {
  require(list.size() == 1 || list.size() == robot.dof(),
          std::string("gate: ") + name + " has " + counted(list.size(), "value") + ", expected 1 or " +
              std::to_string(robot.dof()) + ", one for each joint of " + robot.name);
  Eigen::VectorXd values(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j)
    values[static_cast<Eigen::Index>(j)] = list[list.size() == 1 ? 0 : j];
  return values;
}

}  // namespace

std::string_view to_string(GateReason reason) {
  switch (reason) {
    case GateReason::none:
      return "none";
    case GateReason::not_a_chunk:
      return "not_a_chunk";
    case GateReason::line_too_long:
      return "line_too_long";
    case GateReason::no_map:
      return "no_map";
    case GateReason::too_short:
      return "too_short";
    case GateReason::too_long:
      return "too_long";
    case GateReason::wrong_size:
      return "wrong_size";
    case GateReason::not_finite:
      return "not_finite";
    case GateReason::time_order:
      return "time_order";
    case GateReason::lasts_too_long:
      return "lasts_too_long";
    case GateReason::joint_limit:
      return "joint_limit";
    case GateReason::velocity_limit:
      return "velocity_limit";
    case GateReason::stale_map:
      return "stale_map";
    case GateReason::jump:
      return "jump";
    case GateReason::blocked:
      return "blocked";
    case GateReason::self_collision:
      return "self_collision";
    case GateReason::outside_map:
      return "outside_map";
    case GateReason::not_proved:
      return "not_proved";
  }
  return "";
}

void require_limits(const MotionLimits& limits) {
  require_above_zero(limits.max_velocity, "max_velocity");
  require_above_zero(limits.deceleration, "deceleration");
  require(!limits.deceleration.empty(), "gate: deceleration has no value, expected 1, or one for each joint");
  require(
      std::isfinite(limits.reaction) && limits.reaction >= 0.0,
      "gate: reaction is " + short_text(limits.reaction) + ", expected a finite time not below 0, seconds");
  require(std::isfinite(limits.max_duration) && limits.max_duration > 0.0,
          "gate: max_duration is " + short_text(limits.max_duration) +
              ", expected a finite time above 0, seconds");
}

JointLimits joint_limits(const Robot& robot, const MotionLimits& limits) {
  require_limits(limits);
  JointLimits all{.max_velocity = Eigen::VectorXd(static_cast<Eigen::Index>(robot.dof())),
                  .deceleration = for_each_joint(limits.deceleration, robot, "deceleration"),
                  .reaction = limits.reaction,
                  .max_duration = limits.max_duration};
  const bool is_given = !limits.max_velocity.empty();
  const Eigen::VectorXd given =
      is_given ? for_each_joint(limits.max_velocity, robot, "max_velocity") : Eigen::VectorXd();
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const auto at = static_cast<Eigen::Index>(j);
    const double own = velocity_limit(robot, j);
    all.max_velocity[at] = !is_given ? own : joint.max_velocity > 0.0 ? std::min(own, given[at]) : given[at];
    if (joint.max_acceleration > 0.0)
      all.deceleration[at] = std::min(all.deceleration[at], joint.max_acceleration);
  }
  return all;
}

ChunkFault find_fault(const MotionChunk& chunk, const Robot& robot, const JointLimits& limits) {
  if (ChunkFault fault = size_fault(chunk, robot); fault.reason != GateReason::none) return fault;
  if (ChunkFault fault = finite_fault(chunk); fault.reason != GateReason::none) return fault;
  if (ChunkFault fault = time_fault(chunk.times, limits.max_duration); fault.reason != GateReason::none)
    return fault;
  if (ChunkFault fault = limit_fault(chunk, robot); fault.reason != GateReason::none) return fault;
  return velocity_fault(chunk, robot, limits);
}

std::optional<MotionChunk> drawn_to_limits(const MotionChunk& chunk, const Robot& robot) {
  constexpr double rounding = 0x1p-23;  // of single precision: once as the limit, once as the position
  std::optional<MotionChunk> drawn;
  for (std::size_t i = 0; i < chunk.positions.size(); ++i) {
    const Configuration& q = chunk.positions[i];
    if (static_cast<std::size_t>(q.size()) != robot.dof()) return std::nullopt;
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      const double limit = std::clamp(q[at], robot.joints[j].lower, robot.joints[j].upper);
      if (limit == q[at] || !(std::abs(q[at] - limit) <= std::abs(limit) * rounding)) continue;
      if (!drawn) drawn = chunk;
      drawn->positions[i][at] = limit;
    }
  }
  return drawn;
}

Eigen::VectorXd edge_velocity(const MotionChunk& chunk, std::size_t edge) {
  return (chunk.positions[edge + 1] - chunk.positions[edge]) / (chunk.times[edge + 1] - chunk.times[edge]);
}

bool is_sharp(const MotionChunk& chunk, std::size_t waypoint, const JointLimits& limits) {
  const Eigen::VectorXd change = edge_velocity(chunk, waypoint) - edge_velocity(chunk, waypoint - 1);
  const double time = std::min(chunk.times[waypoint] - chunk.times[waypoint - 1],
                               chunk.times[waypoint + 1] - chunk.times[waypoint]);
  return (change.array().abs() > limits.deceleration.array() * time).any();
}

Configuration stop_from(const Configuration& from, const Eigen::VectorXd& velocity,
                        const JointLimits& limits) {
  const double braking = (velocity.array().abs() / limits.deceleration.array()).maxCoeff();
  return from + velocity * (limits.reaction + braking / 2.0);
}

}  // namespace clearway
