#include "planning/batch/pair_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "planning/geometry/convex_hull.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

constexpr double width_of_one = 0.004, width_of_two = 0.025;  ///< of cells of one joint, of two: rad, metres
constexpr int most_of_one = 4096, most_of_two = 256;          ///< cells of each joint
constexpr std::size_t beyond = 3;                             ///< bytes after the last cell
constexpr int most_together = 64;                             ///< cells that one question may go through
constexpr double margin = 1e-4;  ///< metres that proved bodies are apart, or overlap: no proof is that weak

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

/// Most that a pair approaches while the joints move by `half`, metres.
double most_motion(const BodyPair& pair, const Eigen::VectorXd& half) {
  return pair.approach.dot(half) * (1.0 + 1e-9);
}

/// The body drawn towards its middle: all within `depth` of what is left lies in the body, as a sphere of
/// that radius shrinks out of one about the middle. None where the body is too thin for that.
std::optional<Body> shrunk_body(const Body& body, double depth) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : body.shape.vertices())
    middle += corner / static_cast<double>(body.shape.vertices().size());
  const double inner = body.shape.has_exact_distance()
                           ? -body.shape.signed_distance(middle)
                           : HullPlanes(body.shape.surface()).inner_radius(middle);
  const double share = depth / inner;
  if (!(inner > 0.0 && share < 0.5)) return std::nullopt;
  Body core = body;
  core.cover.clear();
  core.shape = body.shape.scaled(1.0 - share);
  core.link_from_shape = body.link_from_shape * Eigen::Translation3d(share * middle);
  return core;
}

Eigen::Isometry3d at_poses(const Body& body, const LinkPoses& map_from_link) {
  return map_from_link[static_cast<std::size_t>(body.link)] * body.link_from_shape;
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
    level.proofs = std::vector<std::atomic<Proof>>(
        static_cast<std::size_t>(level.counts[0]) * static_cast<std::size_t>(level.counts[1]) + beyond);
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

PairTable::Proof PairTable::proof(const std::array<double, 2>& values) const {
  Cell cell{}, same{};
  return cells_between(values, values, cell, same) ? proof_of(cell) : Proof::none;
}

bool PairTable::is_apart(const std::array<double, 2>& lower, const std::array<double, 2>& upper) const {
  Cell first{}, last{};
  if (!cells_between(lower, upper, first, last)) return false;
  if (first == last) return proof_of(first) == Proof::apart;
  for (const Level& level : levels_) {  // one block around them all
    const Cell block = level.block_of(first);
    if (block != level.block_of(last)) break;
    if (is_block_apart(level, block)) return true;
  }
  if ((last[0] - first[0] + 1) * (last[1] - first[1] + 1) > most_together) return false;
  for (int i = first[0]; i <= last[0]; ++i) {
    for (int k = first[1]; k <= last[1]; ++k) {
      if (proof_of({i, k}) != Proof::apart) return false;
    }
  }
  return true;
}

PairTable::Proof PairTable::proof_of(const Cell& cell) const {
  const Level& finest = levels_.back();
  std::atomic<Proof>& proof =
      finest.proofs[static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(finest.counts[1]) +
                    static_cast<std::size_t>(cell[1])];
  Proof known = proof.load(std::memory_order_relaxed);
  if (known != Proof::unknown) return known;
  const bool is_in_apart = std::any_of(levels_.begin(), levels_.end() - 1, [&](const Level& level) {
    return is_block_apart(level, level.block_of(cell));
  });
  known = is_in_apart ? Proof::apart : prove(finest, cell);
  proof.store(known, std::memory_order_relaxed);
  return known;
}

bool PairTable::is_block_apart(const Level& level, const Cell& block) const {
  std::atomic<Proof>& proof =
      level.proofs[static_cast<std::size_t>(block[0]) * static_cast<std::size_t>(level.counts[1]) +
                   static_cast<std::size_t>(block[1])];
  Proof known = proof.load(std::memory_order_relaxed);
  if (known == Proof::unknown) {
    known = prove(level, block);
    proof.store(known, std::memory_order_relaxed);
  }
  return known == Proof::apart;
}

/// In the middle of the block the bodies are farther apart than they can approach on the way to its border;
/// or, of the finest level, they overlap deeper than they can part.
PairTable::Proof PairTable::prove(const Level& level, const Cell& block) const {
  thread_local LinkPoses poses;
  Configuration q = middle_of(robot_);
  for (std::size_t i = 0; i < 2 && joints_[i] >= 0; ++i) {
    const int first = block[i] << level.shift, last = std::min((block[i] + 1) << level.shift, cells_[i]);
    q[joints_[i]] =
        lower_[i] + 0.5 * (first + last) * width_[i];  // within the limits, as bounds of motion are
  }
  forward_kinematics(robot_, q, poses);
  const Eigen::VectorXd half = half_of(level, block);
  const bool all_apart = std::all_of(pairs_.begin(), pairs_.end(), [&](const BodyPair& pair) {
    return clearway::is_apart(robot_, pair, poses, most_motion(pair, half) + margin);
  });
  if (all_apart) return Proof::apart;
  return level.shift == 0 && is_overlapping(poses) ? Proof::overlap : Proof::none;
}

Eigen::VectorXd PairTable::half_of(const Level& level, const Cell& block) const {
  Eigen::VectorXd half = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot_.dof()));
  for (std::size_t i = 0; i < 2 && joints_[i] >= 0; ++i) {
    const int first = block[i] << level.shift, last = std::min((block[i] + 1) << level.shift, cells_[i]);
    half[joints_[i]] = 0.5 * (last - first) * width_[i] * (1.0 + 1e-6);
  }
  return half;
}

bool PairTable::is_overlapping(const LinkPoses& poses) const {
  std::call_once(made_cores_, [&] { make_cores(); });
  return std::any_of(cores_.begin(), cores_.end(), [&](const std::pair<Body, Body>& cores) {
    const auto& [a, b] = cores;
    return distance(a.shape, at_poses(a, poses), b.shape, at_poses(b, poses), 0.0).upper <= 0.0;
  });
}

void PairTable::make_cores() const {
  const Eigen::VectorXd half = half_of(levels_.back(), {0, 0});
  for (const BodyPair& pair : pairs_) {
    const double depth = 0.5 * (most_motion(pair, half) + margin);
    const auto a = shrunk_body(robot_.bodies[static_cast<std::size_t>(pair.first)], depth);
    const auto b = shrunk_body(robot_.bodies[static_cast<std::size_t>(pair.second)], depth);
    if (a && b) cores_.emplace_back(*a, *b);
  }
}

}  // namespace clearway
