// The proof that a whole edge is free: ConfigurationSpace::is_edge_free.

#include <algorithm>

#include "planning/configuration_space_state.hpp"

namespace clearway {
namespace {

/// The part [begin, end] of an edge, 0..1, with the bodies and pairs that are not proved free on it yet:
/// a range of Scratch::open.
struct Piece {
  double begin = 0.0, end = 1.0;
  std::size_t first_open = 0, last_open = 0;
};

/// Memory of one proof, kept per thread so that an edge allocates nothing once it is warm.
struct Scratch {
  LinkPoses poses;
  std::vector<Piece> pieces;
  std::vector<int> open;       ///< body i as i, pair k as (number of bodies + k)
  std::vector<double> motion;  ///< of each body, or approach of each pair, over the whole edge, metres
  Configuration q;
  Eigen::VectorXd step, distance;
};

enum class Finding { proved, open, blocked };

/// Within three voxels exact shapes are worth asking; farther away another cut is cheaper.
constexpr double exact_within_voxels = 3.0;

/// No point of the body moves farther than `motion` from where it is now.
Finding examine_body(const GuardedBody& body, const Eigen::Isometry3d& pose, double padding, double motion) {
  const double quick = body.quick_clearance(pose);
  if (quick > padding + motion) return Finding::proved;
  if (motion <= exact_within_voxels * body.space().resolution() && body.is_clear(pose, padding + motion)) {
    return Finding::proved;
  }
  return quick > padding || body.is_clear(pose, padding) ? Finding::open : Finding::blocked;
}

Finding examine_pair(const Robot& robot, const BodyPair& pair, const LinkPoses& poses, double approach) {
  if (is_apart(robot, pair, poses, approach)) return Finding::proved;
  return is_apart(robot, pair, poses, 0.0) ? Finding::open : Finding::blocked;
}

}  // namespace

bool ConfigurationSpace::is_edge_free(const Configuration& from, const Configuration& to) const {
  const State& state = *state_;
  if (!state.is_within_limits(from) || !state.is_within_limits(to)) return false;
  thread_local Scratch scratch;
  scratch.step = to - from;
  scratch.distance = scratch.step.cwiseAbs();
  const double length = scratch.step.norm();
  const std::size_t bodies = state.bodies.size(), total = bodies + state.pairs.size();
  scratch.motion.resize(total);
  scratch.open.resize(total);
  for (std::size_t i = 0; i < total; ++i) {
    const Eigen::VectorXd& rates = i < bodies ? state.levers[i] : state.pairs[i - bodies].approach;
    scratch.motion[i] = rates.dot(scratch.distance) * (1.0 + 1e-9);
    scratch.open[i] = static_cast<int>(i);
  }
  scratch.pieces.assign(1, {0.0, 1.0, 0, total});

  for (std::size_t next = 0; next < scratch.pieces.size(); ++next) {  // halves in turn: far samples first
    const Piece piece = scratch.pieces[next];
    const double middle = (piece.begin + piece.end) / 2, half = (piece.end - piece.begin) / 2;
    const bool is_finest = 2.0 * half * length <= state.options.edge_resolution;
    scratch.q = from + middle * scratch.step;
    forward_kinematics(state.robot, scratch.q, scratch.poses);
    const std::size_t first_open = scratch.open.size();
    for (std::size_t i = piece.first_open; i < piece.last_open; ++i) {
      const auto id = static_cast<std::size_t>(scratch.open[i]);
      const double motion = scratch.motion[id] * half;
      const Finding finding =
          id < bodies
              ? examine_body(state.bodies[id], state.pose(scratch.poses, id), state.options.padding, motion)
              : examine_pair(state.robot, state.pairs[id - bodies], scratch.poses, motion);
      if (finding == Finding::proved) continue;
      if (finding == Finding::blocked || is_finest) return false;
      scratch.open.push_back(static_cast<int>(id));
    }
    if (scratch.open.size() == first_open) continue;
    scratch.pieces.push_back({piece.begin, middle, first_open, scratch.open.size()});
    scratch.pieces.push_back({middle, piece.end, first_open, scratch.open.size()});
  }
  return true;
}

double ConfigurationSpace::motion_bound(const Eigen::VectorXd& abs_dq) const {
  double largest = 0.0;
  for (const Eigen::VectorXd& levers : state_->levers) largest = std::max(largest, levers.dot(abs_dq));
  return largest;
}

}  // namespace clearway
