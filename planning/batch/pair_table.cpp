#include "planning/batch/pair_table.hpp"

#include <algorithm>
#include <cmath>

#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

constexpr double width_of_one = 0.004, width_of_two = 0.025;  ///< of cells of one joint, of two: rad, metres
constexpr int most_of_one = 4096, most_of_two = 256;          ///< cells of each joint
constexpr int most_together = 64;                             ///< cells that one question may go through
constexpr double margin = 1e-4;  ///< metres that proved bodies are apart at least: no proof is that weak

/// Some configuration within the limits.
Configuration middle_of(const Robot& robot) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const double middle = (joint.lower + joint.upper) / 2;
    q[static_cast<Eigen::Index>(j)] = std::isfinite(middle) ? middle : 0.0;
  }
  return q;
}

}  // namespace

std::shared_ptr<const PairTable> PairTable::of(const Robot& robot, std::vector<BodyPair> pairs) {
  std::vector<int> moving;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const bool moves = std::any_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
      return pair.approach[static_cast<Eigen::Index>(j)] > 0.0;
    });
    if (!moves) continue;
    if (!std::isfinite(robot.joints[j].upper - robot.joints[j].lower)) return nullptr;
    moving.push_back(static_cast<int>(j));
  }
  if (moving.empty() || moving.size() > 2) return nullptr;
  moving.resize(2, -1);
  return std::shared_ptr<const PairTable>(new PairTable(robot, std::move(pairs), {moving[0], moving[1]}));
}

PairTable::PairTable(const Robot& robot, std::vector<BodyPair> pairs, const std::array<int, 2>& joints)
    : robot_(robot), pairs_(std::move(pairs)), joints_(joints) {
  const bool is_one = joints[1] < 0;
  for (std::size_t i = 0; i < 2 && joints[i] >= 0; ++i) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(joints[i])];
    const double range = joint.upper - joint.lower;
    cells_[i] = static_cast<int>(std::clamp(std::ceil(range / (is_one ? width_of_one : width_of_two)), 1.0,
                                            double(is_one ? most_of_one : most_of_two)));
    lower_[i] = joint.lower;
    width_[i] = range > 0.0 ? range / cells_[i] : 1.0;
    per_unit_[i] = 1.0 / width_[i];
  }
  for (const int shift : block_shifts) {
    Level level;
    level.shift = shift;
    for (std::size_t i = 0; i < 2; ++i) level.counts[i] = ((cells_[i] - 1) >> shift) + 1;
    level.states = std::vector<std::atomic<std::uint8_t>>(static_cast<std::size_t>(level.counts[0]) *
                                                          static_cast<std::size_t>(level.counts[1]));
    levels_.push_back(std::move(level));
  }
}

bool PairTable::cells_between(const std::array<double, 2>& lower, const std::array<double, 2>& upper,
                              Cell& first, Cell& last) const {
  for (std::size_t i = 0; i < 2 && joints_[i] >= 0; ++i) {
    const double low = (lower[i] - lower_[i]) * per_unit_[i];  // a proof reaches a little beyond its cell
    const double high = (upper[i] - lower_[i]) * per_unit_[i];
    if (!(low >= 0.0 && low <= high && high <= cells_[i])) return false;
    first[i] = std::min(static_cast<int>(low), cells_[i] - 1);
    last[i] = std::min(static_cast<int>(high), cells_[i] - 1);
  }
  return true;
}

bool PairTable::is_apart(const std::array<double, 2>& values) const {
  Cell cell{}, same{};
  return cells_between(values, values, cell, same) && is_cell_apart(cell);
}

bool PairTable::is_apart(const std::array<double, 2>& lower, const std::array<double, 2>& upper) const {
  Cell first{}, last{};
  if (!cells_between(lower, upper, first, last)) return false;
  if (first == last) return is_cell_apart(first);
  for (const Level& level : levels_) {  // one block around them all
    const Cell block = level.block_of(first);
    if (block != level.block_of(last)) break;
    if (is_block_apart(level, block)) return true;
  }
  if ((last[0] - first[0] + 1) * (last[1] - first[1] + 1) > most_together) return false;
  for (int i = first[0]; i <= last[0]; ++i) {
    for (int k = first[1]; k <= last[1]; ++k) {
      if (!is_cell_apart({i, k})) return false;
    }
  }
  return true;
}

bool PairTable::is_cell_apart(const Cell& cell) const {
  const Level& finest = levels_.back();
  const auto index = static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(finest.counts[1]) +
                     static_cast<std::size_t>(cell[1]);
  const std::uint8_t known = finest.states[index].load(std::memory_order_relaxed);
  if (known != unknown) return known == apart;
  const bool proved = std::any_of(levels_.begin(), levels_.end(), [&](const Level& level) {
    return is_block_apart(level, level.block_of(cell));
  });
  finest.states[index].store(proved ? apart : open, std::memory_order_relaxed);
  return proved;
}

bool PairTable::is_block_apart(const Level& level, const Cell& block) const {
  std::atomic<std::uint8_t>& state =
      level.states[static_cast<std::size_t>(block[0]) * static_cast<std::size_t>(level.counts[1]) +
                   static_cast<std::size_t>(block[1])];
  std::uint8_t known = state.load(std::memory_order_relaxed);
  if (known == unknown) {
    known = prove(level, block);
    state.store(known, std::memory_order_relaxed);
  }
  return known == apart;
}

/// In the middle of the block the bodies are farther apart than they can approach on the way to its border.
PairTable::State PairTable::prove(const Level& level, const Cell& block) const {
  thread_local LinkPoses poses;
  Configuration q = middle_of(robot_);
  Eigen::VectorXd half = Eigen::VectorXd::Zero(q.size());
  for (std::size_t i = 0; i < 2 && joints_[i] >= 0; ++i) {
    const int first = block[i] << level.shift, last = std::min((block[i] + 1) << level.shift, cells_[i]);
    q[joints_[i]] =
        lower_[i] + 0.5 * (first + last) * width_[i];  // within the limits, as bounds of motion are
    half[joints_[i]] = 0.5 * (last - first) * width_[i] * (1.0 + 1e-6);
  }
  forward_kinematics(robot_, q, poses);
  const bool all_apart = std::all_of(pairs_.begin(), pairs_.end(), [&](const BodyPair& pair) {
    return clearway::is_apart(robot_, pair, poses, pair.approach.dot(half) * (1.0 + 1e-9) + margin);
  });
  return all_apart ? apart : open;
}

}  // namespace clearway
