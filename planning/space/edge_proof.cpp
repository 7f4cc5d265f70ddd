// The proof that a whole edge is free: ConfigurationSpace::is_edge_free.

#include <algorithm>
#include <numeric>

#include "planning/space/configuration_space_state.hpp"

namespace clearway {
namespace {

/// The part [begin, end] of an edge, 0..1, with the bodies and pairs that are not proved free on it yet:
/// a range of Scratch::open.
struct Piece {
  double begin = 0.0, end = 1.0;
  std::size_t first_open = 0, last_open = 0;
  int begin_sample = -1, end_sample = -1;  ///< poses at its ends in Scratch::samples; -1: not known yet
};

/// Memory of one proof, kept per thread so that an edge allocates nothing once it is warm.
struct Scratch {
  std::vector<LinkPoses> samples;
  int used = 0;  ///< of samples
  std::vector<Piece> pieces;
  std::vector<int> open;       ///< body i as i, pair k as (number of bodies + k)
  std::vector<double> motion;  ///< of each body, or approach of each pair, over the whole edge, metres
  std::vector<double> bend;  ///< how far any point of each body leaves its chord, over the whole edge, metres
  Configuration q;
  Eigen::VectorXd step, distance;
  const Configuration *from, *to;
  const EdgePoses* known;

  /// The number of a new sample, at `part` (0..1) of the edge.
  int sample(const Robot& robot, double part) {
    if (static_cast<std::size_t>(used) == samples.size()) samples.emplace_back();
    LinkPoses& poses = samples[static_cast<std::size_t>(used)];
    if (known != nullptr && (part == 0.0 || part == 0.5 || part == 1.0)) {
      poses = part == 0.0 ? known->begin : part == 0.5 ? known->middle : known->end;
      return used++;
    }
    if (part == 1.0)
      q = *to;
    else
      q = *from + part * step;
    forward_kinematics(robot, q, poses);
    return used++;
  }
};

enum class Finding { proved, open, blocked };

/// The hull of a body at two poses stands for all between them when its points leave their chords by no more
/// than this part of a voxel; another cut is cheaper before.
constexpr double bend_within_voxels = 0.5;
/// Nor is it worth while when it is this much longer than a voxel.
constexpr double sweep_within_voxels = 8.0;

/// GuardedBody::is_clear at an end of the edge, with what is known of it, which grows.
bool is_clear_at_end(const GuardedBody& body, const Eigen::Isometry3d& pose, std::size_t id, double margin,
                     RecentCubes& recent, KnownClearances* known) {
  if (known != nullptr && known->at_least[id] >= margin) return true;
  const bool is_clear = body.is_clear(pose, margin, &recent);
  if (known != nullptr && is_clear) known->at_least[id] = margin;
  if (known != nullptr && !is_clear) known->less_than[id] = std::min(known->less_than[id], margin);
  return is_clear;
}

Finding examine_pair(const Robot& robot, const BodyPair& pair, const LinkPoses& poses, double approach) {
  if (is_apart(robot, pair, poses, approach)) return Finding::proved;
  return is_apart(robot, pair, poses, 0.0) ? Finding::open : Finding::blocked;
}

}  // namespace

bool ConfigurationSpace::is_edge_free(const Configuration& from, const Configuration& to) const {
  const State& state = *state_;
  if (!state.is_within_limits(from) || !state.is_within_limits(to)) return false;
  thread_local std::vector<int> all;
  thread_local std::vector<RecentCubes> recent;
  all.resize(state.members());
  std::iota(all.begin(), all.end(), 0);
  recent.assign(state.bodies.size(), {});
  return state.is_edge_free(from, to, all, recent);
}

bool ConfigurationSpace::State::is_edge_free(const Configuration& from, const Configuration& to,
                                             const std::vector<int>& members,
                                             std::vector<RecentCubes>& recent, KnownClearances* known_from,
                                             KnownClearances* known_to, const EdgePoses* poses) const {
  const State& state = *this;
  thread_local Scratch scratch;
  scratch.from = &from;
  scratch.to = &to;
  scratch.known = poses;
  scratch.step = to - from;
  scratch.distance = scratch.step.cwiseAbs();
  const double length = scratch.step.cwiseProduct(state.matters).norm();
  const std::size_t count = state.bodies.size();
  scratch.motion.resize(state.members());
  scratch.bend.resize(count);
  for (const int member : members) {
    const auto i = static_cast<std::size_t>(member);
    scratch.motion[i] = state.motion(i, scratch.distance);
    if (i < count)  // |x''| <= 2 (all turns) (all motion), and a chord is off by 1/8 of it
      scratch.bend[i] = state.turns[i].dot(scratch.distance) * scratch.motion[i] / 4.0 * (1.0 + 1e-9);
  }
  scratch.used = 0;
  scratch.open.clear();
  for (const int member : members) {  // what stands still is free on the edge where it is free at its start
    const auto i = static_cast<std::size_t>(member);
    if (scratch.motion[i] > 0.0) {
      scratch.open.push_back(member);
      continue;
    }
    if (scratch.used == 0) scratch.sample(state.robot, 0.0);
    if (i < count ? !state.bodies[i].is_clear(state.pose(scratch.samples[0], i), state.options.padding)
                  : !is_apart(state.robot, state.pairs[i - count], scratch.samples[0], 0.0))
      return false;
  }
  scratch.pieces.assign(1, {0.0, 1.0, 0, scratch.open.size(), scratch.used - 1, -1});
  const double resolution = state.map.resolution();
  const double finest = state.options.edge_resolution / std::max(length, state.options.edge_resolution);
  /// No point of the body is farther than its motion over half the piece from where it is at the middle.
  const auto examine_body = [&](std::size_t id, Piece& piece, int middle) {
    const GuardedBody& body = state.bodies[id];
    const double part = piece.end - piece.begin, padding = state.options.padding;
    const auto pose = [&](int sample) -> const Eigen::Isometry3d& {
      return state.pose(scratch.samples[static_cast<std::size_t>(sample)], id);
    };
    if (body.is_quickly_clear(pose(middle), padding + scratch.motion[id] * part / 2)) return Finding::proved;
    // What halving to the finest piece needs at least; a body that is nearer anywhere will not be proved.
    const double least = padding + scratch.motion[id] * finest / 2;
    const double bend = scratch.bend[id] * part * part;
    if (bend <= bend_within_voxels * resolution &&
        scratch.motion[id] * part <= sweep_within_voxels * resolution) {
      if (piece.begin_sample < 0) piece.begin_sample = scratch.sample(state.robot, piece.begin);
      if (piece.end_sample < 0) piece.end_sample = scratch.sample(state.robot, piece.end);
      const Eigen::Isometry3d &begin = pose(piece.begin_sample), &end = pose(piece.end_sample);
      // What is known to block, or is met again, is what the looks below would find.
      if (piece.begin == 0.0 && known_from != nullptr && known_from->less_than[id] <= least)
        return Finding::blocked;
      if (piece.end == 1.0 && known_to != nullptr && known_to->less_than[id] <= least)
        return Finding::blocked;
      if (body.is_met(pose(middle), least, recent[id])) return Finding::blocked;
      if (body.is_sweep_clear(begin, pose(middle), end, least + bend, recent[id])) return Finding::proved;
      if (body.is_met(pose(middle), least, recent[id])) return Finding::blocked;
      if (piece.begin == 0.0 && !is_clear_at_end(body, begin, id, least, recent[id], known_from))
        return Finding::blocked;
      if (piece.end == 1.0 && !is_clear_at_end(body, end, id, least, recent[id], known_to))
        return Finding::blocked;
    }
    return body.is_clear(pose(middle), least, &recent[id]) ? Finding::open : Finding::blocked;
  };

  for (std::size_t next = 0; next < scratch.pieces.size(); ++next) {  // halves in turn: far samples first
    Piece piece = scratch.pieces[next];
    const double middle = (piece.begin + piece.end) / 2, half = (piece.end - piece.begin) / 2;
    const bool is_finest = 2.0 * half * length <= state.options.edge_resolution;
    const int sample = scratch.sample(state.robot, middle);
    const std::size_t first_open = scratch.open.size();
    for (std::size_t i = piece.first_open; i < piece.last_open; ++i) {
      const auto id = static_cast<std::size_t>(scratch.open[i]);
      const Finding finding = id < count ? examine_body(id, piece, sample)
                                         : examine_pair(state.robot, state.pairs[id - count],
                                                        scratch.samples[static_cast<std::size_t>(sample)],
                                                        scratch.motion[id] * half);
      if (finding == Finding::proved) continue;
      if (finding == Finding::blocked || is_finest) return false;
      scratch.open.push_back(static_cast<int>(id));
    }
    if (scratch.open.size() == first_open) continue;
    scratch.pieces.push_back(
        {piece.begin, middle, first_open, scratch.open.size(), piece.begin_sample, sample});
    scratch.pieces.push_back({middle, piece.end, first_open, scratch.open.size(), sample, piece.end_sample});
  }
  return true;
}

double ConfigurationSpace::motion_bound(const Eigen::VectorXd& abs_dq) const {
  double largest = 0.0;
  for (const Eigen::VectorXd& levers : state_->levers) largest = std::max(largest, levers.dot(abs_dq));
  return largest;
}

}  // namespace clearway
