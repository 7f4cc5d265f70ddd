// The proof by shapes that a whole edge is free, where spheres do not decide (edge_checks.cpp).

#include <algorithm>
#include <numeric>

#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// The part [begin, end] of an edge, 0..1, with the bodies and pairs that are not proved free on it yet:
/// a range of EdgeScratch::open.
struct Piece {
  double begin = 0.0, end = 1.0;
  std::size_t first_open = 0, last_open = 0;
  int begin_sample = -1, end_sample = -1;  ///< poses at its ends in EdgeScratch::samples; -1: not known yet
  bool is_near = false;  ///< spheres were looked at: what is open is near something all along
};

/// A member that is open on a piece of EdgePieces.
struct OpenPart {
  int member;
  double begin, end;
  std::size_t place;  ///< in EdgePieces::open_members()
};

/// Memory of one proof, kept per thread so that an edge allocates nothing once it is warm.
struct EdgeScratch {
  std::vector<LinkPoses> samples;
  int used = 0;                                 ///< of samples
  std::vector<std::pair<double, int>> borders;  ///< where pieces end, and the sample there
  std::vector<Piece> pieces;
  std::vector<int> open;       ///< body i as i, pair k as (number of bodies + k)
  std::vector<double> motion;  ///< of each body, or approach of each pair, over the whole edge, metres
  std::vector<double> bend;  ///< how far any point of each body leaves its chord, over the whole edge, metres
  std::vector<double> aside;  ///< motion or approach of each member by leaving the edge, metres
  std::vector<OpenPart> parts;
  std::vector<char> is_proved;  ///< of each of EdgePieces::open_members()
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

  /// The same where a piece ends, which may be where the one before began or ended.
  int sample_at_border(const Robot& robot, double part) {
    constexpr std::size_t some = 12;
    for (std::size_t i = borders.size(); i-- > 0 && i + some >= borders.size();) {
      if (borders[i].first == part) return borders[i].second;
    }
    borders.emplace_back(part, sample(robot, part));
    return borders.back().second;
  }
};

EdgeScratch& scratch_for(const Configuration& from, const Configuration& to, const EdgePoses* poses) {
  thread_local EdgeScratch scratch;
  scratch.from = &from;
  scratch.to = &to;
  scratch.known = poses;
  scratch.step = to - from;
  scratch.distance = scratch.step.cwiseAbs();
  return scratch;
}

/// What the bodies of a robot met lately in this thread.
struct MetCubes {
  explicit MetCubes(const SphereRobot& robot) : of_body(robot.members) {}
  std::vector<RecentCubes> of_body;
};

enum class Finding { proved, open, blocked };

/// The hull of a body at two poses stands for all between them when its points leave their chords by no more
/// than this part of a voxel; another cut is cheaper before.
constexpr double bend_within_voxels = 0.5;
/// Nor is it worth while when it is this much longer than a voxel.
constexpr double sweep_within_voxels = 8.0;

/// BodyCollision::is_clear at an end of the edge, with what is known of it, which grows.
bool is_clear_at_end(const BodyCollision& body, const Eigen::Isometry3d& pose, std::size_t id, double margin,
                     RecentCubes& recent, KnownClearances* known) {
  if (known != nullptr && known->at_least[id] >= margin) return true;
  const bool is_clear = body.is_clear(pose, margin, &recent);
  if (known != nullptr && is_clear) known->at_least[id] = margin;
  if (known != nullptr && !is_clear) known->less_than[id] = std::min(known->less_than[id], margin);
  return is_clear;
}

/// One proof: the edge, or each of its pieces, is halved until each member is proved free on each part; what
/// is open on pieces in a row is tried on all of them first.
class EdgeProof {
 public:
  /// @param deviation how far each joint may be from the edge; null: not at all
  EdgeProof(const CollisionModel& model, EdgeScratch& scratch, std::vector<RecentCubes>& recent,
            KnownClearances* known_from, KnownClearances* known_to,
            const Eigen::VectorXd* deviation = nullptr)
      : model_(model), scratch_(scratch), recent_(recent), known_from_(known_from), known_to_(known_to) {
    scratch_.aside.assign(model_.members(), 0.0);
    if (deviation == nullptr) return;
    for (std::size_t i = 0; i < model_.members(); ++i) scratch_.aside[i] = model_.motion(i, *deviation);
  }

  bool holds(const std::vector<int>& members) {
    bound_motions(members);
    if (!stands_free(members)) return false;
    scratch_.pieces.assign(1, {0.0, 1.0, 0, scratch_.open.size(), scratch_.used - 1, -1, false});
    return examine_pieces();
  }

  /// The same for parts of the edge, each with members of its own.
  bool holds_on(const std::vector<EdgePieces::Piece>& pieces, const std::vector<int>& members) {
    bound_motions(members);
    scratch_.used = 0;
    scratch_.borders.clear();
    scratch_.open.clear();
    scratch_.pieces.clear();
    if (!prove_rows(pieces, members)) return false;
    for (const EdgePieces::Piece& piece : pieces) {
      const std::size_t first = scratch_.open.size();
      for (int i = piece.first; i < piece.last; ++i) {
        const int member = members[static_cast<std::size_t>(i)];
        if (scratch_.is_proved[static_cast<std::size_t>(i)] != 0) continue;
        if (scratch_.motion[static_cast<std::size_t>(member)] > 0.0) {
          scratch_.open.push_back(member);
          continue;
        }
        if (scratch_.used == 0) scratch_.sample(model_.robot, 0.0);
        if (!is_clear_where_it_stands(static_cast<std::size_t>(member))) return false;
      }
      scratch_.pieces.push_back({piece.begin, piece.end, first, scratch_.open.size(), -1, -1, true});
    }
    return examine_pieces();
  }

 private:
  /// What is open on pieces in a row is mostly proved on all of them at once, or on half of them. False: it
  /// is not free where the edge ends.
  bool prove_rows(const std::vector<EdgePieces::Piece>& pieces, const std::vector<int>& members) {
    find_open_parts(pieces, members);
    scratch_.is_proved.assign(members.size(), 0);
    const std::vector<OpenPart>& parts = scratch_.parts;
    for (std::size_t first = 0, last = 1; last <= parts.size(); ++last) {
      const bool goes_on = last < parts.size() && parts[last].member == parts[first].member &&
                           parts[last].begin == parts[last - 1].end;
      if (goes_on) continue;
      if (!prove_at_once(first, last)) {
        if (parts[last - 1].end == 1.0 && !is_free_at_end(parts[last - 1].member)) return false;
        prove_halves(first, last);
      }
      first = last;
    }
    return true;
  }

  /// Those that move, member by member, in the order of the edge.
  void find_open_parts(const std::vector<EdgePieces::Piece>& pieces, const std::vector<int>& members) {
    scratch_.parts.clear();
    for (const EdgePieces::Piece& piece : pieces) {
      for (auto i = static_cast<std::size_t>(piece.first); i < static_cast<std::size_t>(piece.last); ++i) {
        if (scratch_.motion[static_cast<std::size_t>(members[i])] > 0.0)
          scratch_.parts.push_back({members[i], piece.begin, piece.end, i});
      }
    }
    std::sort(scratch_.parts.begin(), scratch_.parts.end(), [](const OpenPart& a, const OpenPart& b) {
      return a.member != b.member ? a.member < b.member : a.begin < b.begin;
    });
  }

  bool prove_at_once(std::size_t first, std::size_t last) {
    const OpenPart &begin = scratch_.parts[first], &end = scratch_.parts[last - 1];
    if (!is_proved_on(static_cast<std::size_t>(begin.member), begin.begin, end.end)) return false;
    for (std::size_t i = first; i < last; ++i) scratch_.is_proved[scratch_.parts[i].place] = 1;
    return true;
  }

  void prove_halves(std::size_t first, std::size_t last) {
    const std::size_t middle = first + (last - first) / 2;
    if (middle - first > 1 && !prove_at_once(first, middle)) prove_halves(first, middle);
    if (last - middle > 1 && !prove_at_once(middle, last)) prove_halves(middle, last);
  }

  /// With room for what the pieces themselves would ask: their proofs would succeed.
  bool is_proved_on(std::size_t id, double from, double to) {
    constexpr double room = 1e-6;  // metres
    const double part = to - from;
    const auto sample = [&](double at) { return scratch_.sample_at_border(model_.robot, at); };
    if (id >= model_.bodies.size())
      return is_apart(model_.robot, model_.pairs[id - model_.bodies.size()], poses(sample((from + to) / 2)),
                      scratch_.motion[id] * part / 2 + scratch_.aside[id] + room);
    if (!is_short(id, part)) return false;
    const int begin = sample(from), middle = sample((from + to) / 2), end = sample(to);
    return model_.bodies[id].is_sweep_clear(pose(begin, id), pose(middle, id), pose(end, id),
                                            least(id) + 2.0 * scratch_.bend[id] * part * part + room,
                                            recent_[id]);
  }

  /// Where the edge ends, with no room for motion: what is not clear there is proved on no piece up to it.
  bool is_free_at_end(int member) {
    const auto id = static_cast<std::size_t>(member);
    const int end = scratch_.sample_at_border(model_.robot, 1.0);
    if (id >= model_.bodies.size())
      return is_apart(model_.robot, model_.pairs[id - model_.bodies.size()], poses(end), scratch_.aside[id]);
    return model_.bodies[id].is_clear(pose(end, id), model_.options.padding + scratch_.aside[id],
                                      &recent_[id]);
  }

  bool examine_pieces() {
    for (std::size_t next = 0; next < scratch_.pieces.size(); ++next) {  // halves in turn: far samples first
      if (!examine_piece(scratch_.pieces[next])) return false;
    }
    return true;
  }

  void bound_motions(const std::vector<int>& members) {
    length_ = scratch_.step.cwiseProduct(model_.matters).norm();
    scratch_.motion.resize(model_.members());
    scratch_.bend.resize(model_.bodies.size());
    for (const int member : members) {
      const auto i = static_cast<std::size_t>(member);
      scratch_.motion[i] = model_.motion(i, scratch_.distance);
      if (i < model_.bodies.size())  // |x''| <= 2 (all turns) (all motion), and a chord is off by 1/8 of it
        scratch_.bend[i] = model_.turns[i].dot(scratch_.distance) * scratch_.motion[i] / 4.0 * (1.0 + 1e-9);
    }
  }

  /// What stands still is free on the edge where it is free at its start; what moves stays open.
  bool stands_free(const std::vector<int>& members) {
    scratch_.used = 0;
    scratch_.borders.clear();
    scratch_.open.clear();
    for (const int member : members) {
      const auto i = static_cast<std::size_t>(member);
      if (scratch_.motion[i] > 0.0) {
        scratch_.open.push_back(member);
        continue;
      }
      if (scratch_.used == 0) scratch_.sample(model_.robot, 0.0);
      if (!is_clear_where_it_stands(i)) return false;
    }
    return true;
  }

  bool is_clear_where_it_stands(std::size_t member) {
    const std::size_t bodies = model_.bodies.size();
    const double aside = scratch_.aside[member];
    return member < bodies
               ? model_.bodies[member].is_clear(pose(0, member), model_.options.padding + aside)
               : is_apart(model_.robot, model_.pairs[member - bodies], scratch_.samples[0], aside);
  }

  /// Proves what it can half way, and leaves the rest to both halves. False: something is not free, or not
  /// proved on the shortest piece.
  bool examine_piece(Piece piece) {
    const double middle = (piece.begin + piece.end) / 2, half = (piece.end - piece.begin) / 2;
    const bool is_finest = 2.0 * half * length_ <= model_.options.edge_resolution;
    const int sample = scratch_.sample(model_.robot, middle);
    const std::size_t first_open = scratch_.open.size();
    for (std::size_t i = piece.first_open; i < piece.last_open; ++i) {
      const auto id = static_cast<std::size_t>(scratch_.open[i]);
      const Finding finding = examine(id, piece, sample);
      if (finding == Finding::proved) continue;
      if (finding == Finding::blocked || is_finest) return false;
      scratch_.open.push_back(static_cast<int>(id));
    }
    const std::size_t last_open = scratch_.open.size();
    if (last_open == first_open) return true;
    scratch_.pieces.push_back(
        {piece.begin, middle, first_open, last_open, piece.begin_sample, sample, false});
    scratch_.pieces.push_back({middle, piece.end, first_open, last_open, sample, piece.end_sample, false});
    return true;
  }

  Finding examine(std::size_t id, Piece& piece, int middle) {
    if (id < model_.bodies.size()) return examine_body(id, piece, middle);
    const BodyPair& pair = model_.pairs[id - model_.bodies.size()];
    const double approach = scratch_.motion[id] * ((piece.end - piece.begin) / 2) + scratch_.aside[id];
    if (is_apart(model_.robot, pair, poses(middle), approach)) return Finding::proved;
    return is_apart(model_.robot, pair, poses(middle), 0.0) ? Finding::open : Finding::blocked;
  }

  /// No point of the body is farther than its motion over half the piece from where it is at the middle.
  Finding examine_body(std::size_t id, Piece& piece, int middle) {
    const BodyCollision& body = model_.bodies[id];
    const double part = piece.end - piece.begin, padding = model_.options.padding + scratch_.aside[id];
    if (piece.is_near && !is_short(id, part))  // spheres prove nothing here
      return body.is_met(pose(middle, id), padding, recent_[id]) ? Finding::blocked : Finding::open;
    if (!piece.is_near && body.is_quickly_clear(pose(middle, id), padding + scratch_.motion[id] * part / 2))
      return Finding::proved;
    if (is_short(id, part)) {
      const Finding finding = examine_sweep(id, piece, middle, least(id), scratch_.bend[id] * part * part);
      if (finding != Finding::open) return finding;
    }
    return body.is_clear(pose(middle, id), least(id), &recent_[id]) ? Finding::open : Finding::blocked;
  }

  /// Whether a body turns and moves so little on such a part of the edge that its hull at both ends says
  /// enough.
  bool is_short(std::size_t id, double part) const {
    const double resolution = model_.map.resolution();
    return scratch_.bend[id] * part * part <= bend_within_voxels * resolution &&
           scratch_.motion[id] * part <= sweep_within_voxels * resolution;
  }

  /// What halving to the finest piece needs at least; a body that is nearer anywhere will not be proved.
  double least(std::size_t id) const {
    const double finest = model_.options.edge_resolution / std::max(length_, model_.options.edge_resolution);
    return model_.options.padding + scratch_.aside[id] + scratch_.motion[id] * finest / 2;
  }

  /// The hull of the body at the ends and half way, grown by how far its points leave their chords.
  Finding examine_sweep(std::size_t id, Piece& piece, int middle, double least, double bend) {
    const BodyCollision& body = model_.bodies[id];
    if (piece.begin_sample < 0) piece.begin_sample = scratch_.sample_at_border(model_.robot, piece.begin);
    if (piece.end_sample < 0) piece.end_sample = scratch_.sample_at_border(model_.robot, piece.end);
    const Eigen::Isometry3d &begin = pose(piece.begin_sample, id), &end = pose(piece.end_sample, id);
    // What is known to block, or is met again, is what the looks below would find.
    if (piece.begin == 0.0 && known_from_ != nullptr && known_from_->less_than[id] <= least)
      return Finding::blocked;
    if (piece.end == 1.0 && known_to_ != nullptr && known_to_->less_than[id] <= least)
      return Finding::blocked;
    if (body.is_met(pose(middle, id), least, recent_[id])) return Finding::blocked;
    if (body.is_sweep_clear(begin, pose(middle, id), end, least + bend, recent_[id])) return Finding::proved;
    if (body.is_met(pose(middle, id), least, recent_[id])) return Finding::blocked;
    if (piece.begin == 0.0 && !is_clear_at_end(body, begin, id, least, recent_[id], known_from_))
      return Finding::blocked;
    if (piece.end == 1.0 && !is_clear_at_end(body, end, id, least, recent_[id], known_to_))
      return Finding::blocked;
    return Finding::open;
  }

  const LinkPoses& poses(int sample) const { return scratch_.samples[static_cast<std::size_t>(sample)]; }
  const Eigen::Isometry3d& pose(int sample, std::size_t body) const {
    return model_.pose(poses(sample), body);
  }

  const CollisionModel& model_;
  EdgeScratch& scratch_;
  std::vector<RecentCubes>& recent_;
  KnownClearances *known_from_, *known_to_;
  double length_ = 0.0;  ///< of the edge, over the joints that matter
};

}  // namespace

bool ConfigurationSpace::is_edge_free(const Configuration& from, const Configuration& to,
                                      const Eigen::VectorXd& deviation) const {
  const WorkMeter::Scope scope(meter_, PlanWork::proofs);
  const CollisionModel& model = *model_;
  const bool is_sound =
      deviation.size() == from.size() && deviation.allFinite() && deviation.minCoeff() >= 0.0;
  if (!is_sound || !model.is_within_limits(from) || !model.is_within_limits(to)) return false;
  std::vector<int> all(model.members());
  std::iota(all.begin(), all.end(), 0);
  std::vector<RecentCubes> recent(model.bodies.size());
  EdgeScratch& scratch = scratch_for(from, to, nullptr);
  return EdgeProof(model, scratch, recent, nullptr, nullptr, &deviation).holds(all);
}

bool CollisionModel::is_edge_free_by_shapes(const Configuration& from, const Configuration& to) const {
  thread_local std::vector<int> all;
  thread_local std::vector<RecentCubes> recent;
  all.resize(members());
  std::iota(all.begin(), all.end(), 0);
  recent.assign(bodies.size(), {});
  return is_edge_free(from, to, all, recent);
}

bool CollisionModel::are_pieces_free(const Configuration& from, const Configuration& to,
                                     const std::vector<EdgePieces::Piece>& pieces,
                                     const std::vector<int>& members) const {
  EdgeScratch& scratch = scratch_for(from, to, nullptr);
  MetCubes& met = of_this_thread<MetCubes>(*spheres);
  return EdgeProof(*this, scratch, met.of_body, nullptr, nullptr).holds_on(pieces, members);
}

bool CollisionModel::is_edge_free(const Configuration& from, const Configuration& to,
                                  const std::vector<int>& members, std::vector<RecentCubes>& recent,
                                  KnownClearances* known_from, KnownClearances* known_to,
                                  const EdgePoses* poses) const {
  EdgeScratch& scratch = scratch_for(from, to, poses);
  return EdgeProof(*this, scratch, recent, known_from, known_to).holds(members);
}

}  // namespace clearway
