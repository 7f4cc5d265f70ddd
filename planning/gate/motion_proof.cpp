#include "planning/gate/motion_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {
namespace {

/// How much farther than the finest step of a proof to look for what is in the way.
constexpr double looks_on = 128.0;

Configuration between(const Configuration& from, const Configuration& to, double part) {
  return from + part * (to - from);
}

/// The nearest voxel or body to the robot at `q`.
Verdict nearest_to(const ConfigurationSpace& space, const Configuration& q) {
  Verdict verdict;
  verdict.point.setConstant(std::numeric_limits<double>::quiet_NaN());
  const double edge = space.map().resolution();
  const auto pairs = space.proximity_constraints(q, 2.0 * edge);
  const auto nearest = std::min_element(pairs.begin(), pairs.end(),
                                        [](const auto& a, const auto& b) { return a.distance < b.distance; });
  if (nearest == pairs.end()) return verdict;
  verdict.part = space.robot().bodies[static_cast<std::size_t>(nearest->body)].part;
  const BlockedSpace* const blocked = space.blocked_space(nearest->body);
  const double away = nearest->distance + space.options().padding;
  for (const double deep : {0.01 * edge, 0.25 * edge, 0.5 * edge}) {
    const Eigen::Vector3d at = nearest->point + (away + deep) * nearest->normal;
    if (blocked == nullptr || !blocked->is_blocked(at)) continue;
    verdict.point = ((at / edge).array().floor() + 0.5) * edge;
    break;
  }
  return verdict;
}

/// ConfigurationSpace::check, sooner where it is free.
Verdict verdict_at(const ConfigurationSpace& space, const Configuration& q) {
  return space.is_free(q) ? Verdict() : space.check(q);
}

/// Whether the chunk of the configurations 0..k may end there: the way straight on until it stands.
bool stops_free(const ProofSpace& proof, const MotionChunk& chunk, std::size_t k, const JointLimits& limits) {
  const Configuration& from = chunk.positions[k];
  const Configuration stop = stop_from(from, edge_velocity(chunk, k - 1), limits);
  return proof.space.is_free(stop) && proof.holds(from, stop);  // it mostly fails where it ends
}

ProvedPart part_until(const MotionChunk& chunk, std::size_t k, const JointLimits& limits) {
  const Configuration& position = chunk.positions[k];
  return {chunk.times[k], position, stop_from(position, edge_velocity(chunk, k - 1), limits)};
}

/// The configurations 0..k, and one `part` of the way to the next.
MotionChunk cut(const MotionChunk& chunk, std::size_t k, double part) {
  const auto first = static_cast<std::ptrdiff_t>(k) + 1;
  MotionChunk head{{chunk.times.begin(), chunk.times.begin() + first},
                   {chunk.positions.begin(), chunk.positions.begin() + first}};
  head.times.push_back(chunk.times[k] + part * (chunk.times[k + 1] - chunk.times[k]));
  head.positions.push_back(between(chunk.positions[k], chunk.positions[k + 1], part));
  return head;
}

}  // namespace

std::string to_text(const MotionPiece& piece) {
  const auto name = [](std::size_t i) { return "positions[" + std::to_string(i) + "]"; };
  switch (piece.kind) {
    case MotionPiece::Kind::joining:
      return "from where the robot is to " + name(0);
    case MotionPiece::Kind::edge:
      return "from " + name(piece.waypoint) + " to " + name(piece.waypoint + 1);
    case MotionPiece::Kind::braking:
      return "braking straight on from " + name(piece.waypoint);
  }
  return "";
}

std::vector<StraightPiece> straight_pieces(const MotionChunk& chunk, const JointLimits& limits,
                                           const std::vector<Configuration>& standing) {
  using Kind = MotionPiece::Kind;
  std::vector<StraightPiece> pieces;
  const std::vector<Configuration>& q = chunk.positions;
  for (const Configuration& place : standing)
    if (place != q[0]) pieces.push_back({{Kind::joining, 0}, place, q[0]});
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    // Who waits where a proved piece ends needs no other proof.
    if (q[i] != q[i + 1] || pieces.empty()) pieces.push_back({{Kind::edge, i}, q[i], q[i + 1]});
    const std::size_t end = i + 1;
    if (end + 1 < q.size() && !is_sharp(chunk, end, limits)) continue;
    const Configuration stop = stop_from(q[end], edge_velocity(chunk, i), limits);
    if (stop != q[end]) pieces.push_back({{Kind::braking, end}, q[end], stop});
  }
  return pieces;
}

std::optional<Configuration> stop_at_leaving(const MotionChunk& passed, std::size_t at,
                                             const MotionChunk& next, const JointLimits& limits) {
  if (at == 0) return std::nullopt;
  const Configuration& place = passed.positions[at];
  const double before = passed.times[at] - passed.times[at - 1], after = next.times[1] - next.times[0];
  const MotionChunk corner{
      {0.0, before, before + after},
      {passed.positions[at - 1], place, place + (next.positions[1] - next.positions[0])}};
  if (!is_sharp(corner, 1, limits)) return std::nullopt;
  return stop_from(place, edge_velocity(passed, at - 1), limits);
}

std::size_t first_unproved(const ProofSpace& proof, const std::vector<StraightPiece>& pieces) {
  const auto unproved = std::find_if(pieces.begin(), pieces.end(), [&](const StraightPiece& piece) {
    return !proof.holds(piece.from, piece.to);
  });
  return static_cast<std::size_t>(unproved - pieces.begin());
}

ProofEnd find_proof_end(const ProofSpace& proof, const StraightPiece& piece) {
  const ConfigurationSpace& space = proof.space;
  const auto at = [&](double part) { return between(piece.from, piece.to, part); };
  ProofEnd end;
  end.obstruction = verdict_at(space, piece.from);
  if (!end.obstruction.is_free()) return end;
  double proved = 0.0, open = 1.0, begin = 0.0;  // from `begin` to `open` is what was not proved last
  std::optional<bool> is_open_free;              // by what blocks it; none: it was not asked yet
  const double finest = space.options().edge_resolution / (piece.to - piece.from).norm();
  while (open - proved > std::max(finest, 1e-9)) {
    const double middle = (proved + open) / 2.0;
    const bool is_free = space.is_edge_free(at(proved), at(middle));
    if (is_free && !proof.bounds.leaving(space.robot(), at(proved), at(middle))) {
      proved = middle;
    } else {
      open = middle;
      begin = proved;
      is_open_free = is_free;
    }
  }
  end.parameter = proved;
  // Along the bounds a short piece may be proved inside where the longer one that was asked for is not.
  const bool is_free = is_open_free ? *is_open_free : space.is_edge_free(at(begin), at(open));
  end.leaving = proof.bounds.leaving(space.robot(), at(is_free ? begin : proved), at(open));
  const bool leaves_first = end.leaving && (is_free || space.is_edge_free(at(proved), at(open)));
  // What is too near to be proved is mostly touched a little farther on, and bounds are left.
  double part = open;
  for (double step = open - proved; step <= looks_on * (open - proved) && part <= 1.0; step *= 2.0) {
    if (!leaves_first) end.obstruction = verdict_at(space, at(part));
    if (!end.obstruction.is_free()) {
      end.leaving.reset();
      return end;
    }
    const auto left = proof.bounds.leaving(space.robot(), at(part), at(part));
    if (end.leaving && left && left->distance > 0.0) {
      end.leaving = left;
      return end;
    }
    part = open + step;
  }
  if (!end.leaving) end.obstruction = nearest_to(space, at(open));
  return end;
}

std::optional<ProvedPart> proved_part(const ProofSpace& proof, const MotionChunk& chunk,
                                      const JointLimits& limits, const MotionPiece& unproved) {
  if (unproved.kind == MotionPiece::Kind::joining) return std::nullopt;
  std::size_t k = unproved.waypoint;
  if (unproved.kind == MotionPiece::Kind::braking && k == 0) return std::nullopt;  // as it leaves another one
  if (unproved.kind == MotionPiece::Kind::braking) --k;  // there it cannot stop, and no waypoint follows
  while (k > 0 && !stops_free(proof, chunk, k, limits)) --k;
  std::optional<ProvedPart> part;
  if (k > 0) part = part_until(chunk, k, limits);
  // Between there and the next configuration, to a 64th.
  double proved = 0.0;
  for (double step = 0.5; step >= 1.0 / 64.0; step /= 2.0) {
    const MotionChunk head = cut(chunk, k, proved + step);
    const bool is_later = head.times[k] < head.times[k + 1] && head.times[k + 1] < chunk.times[k + 1];
    if (!is_later || !stops_free(proof, head, k + 1, limits) ||
        !proof.holds(head.positions[k], head.positions[k + 1]))
      continue;
    proved += step;
    part = part_until(head, k + 1, limits);
  }
  return part;
}

}  // namespace clearway
