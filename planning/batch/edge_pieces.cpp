#include "planning/batch/edge_pieces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "planning/batch/core_lanes.hpp"

namespace clearway {
namespace {

constexpr int first_cut = 16, further_cut = 4;
constexpr int quick_cut = 8;  ///< half of the lanes, and of the time where a register holds no more
constexpr std::size_t most_pieces = 4096;

auto row(LaneFloats& lanes) {
  return Eigen::Map<Eigen::Array<float, lane_count, 1>, Eigen::Aligned16>(lanes.at);
}
auto row(LaneDoubles& lanes) {
  return Eigen::Map<Eigen::Array<double, lane_count, 1>, Eigen::Aligned16>(lanes.at);
}

}  // namespace

/// How far a sphere's middle moves at most, whatever the configuration, and half of |x''| at most, over the
/// whole edge: the second derivatives by two joints are turns of the way that the later one moves the point
/// (d^2 x / dq_i dq_k = z_i x dx / dq_k for i above k), so |x''| is at most
/// sum_i turn_i |d_i| (lever_i |d_i| + 2 sum_{k below i} lever_k |d_k|).
/// @param above joints of this frame and of its parents do not count.
EdgePieces::Bounds EdgePieces::bounds_of(int frame, int above) const {
  double sum = 0.0, below = 0.0;
  const auto index = static_cast<std::size_t>(frame);
  for (int i = frame; i != above && i > 0; i = robot_->frames[static_cast<std::size_t>(i)].parent) {
    const auto mover = static_cast<std::size_t>(i);
    const double moved = robot_->lever_of(index, mover) * distance_[mover];
    if (robot_->frames[mover].turns) sum += distance_[mover] * (moved + 2.0 * below);
    below += moved;
  }
  return {below * (1.0 + 1e-5), 0.5 * sum * (1.0 + 1e-5)};
}

void EdgePieces::bound_bends() {
  distance_.assign(robot_->frames.size(), 0.0);
  for (std::size_t i = 1; i < robot_->frames.size(); ++i)
    distance_[i] = std::abs(robot_->frames[i].multiplier * step_[robot_->frames[i].joint]);
  bend_.clear();
  for (std::size_t i = 0; i < robot_->frames.size(); ++i)
    bend_.push_back(static_cast<float>(bounds_of(static_cast<int>(i), 0).bend));
  pair_bend_.clear();
  approach_.clear();
  for (const SphereRobot::FramePair& pair : robot_->frame_pairs) {
    const Bounds a = bounds_of(pair.a, pair.meet), b = bounds_of(pair.b, pair.meet);
    pair_bend_.push_back(static_cast<float>(a.bend + b.bend));
    approach_.push_back(static_cast<float>(a.motion + b.motion));
  }
}

/// Of the first pieces, so much of the edge was proved free from its start on.
double EdgePieces::share_in_front() const {
  return double(std::min(std::countr_zero(unsigned{lanes_.failing()}), first_cut)) / first_cut;
}

/// True when the middle of a piece touches something, with the share of the edge that is proved before that.
bool EdgePieces::is_touching(double least_share) {
  const auto least =
      static_cast<unsigned>(std::clamp(std::ceil(least_share * first_cut), 1.0, double(first_cut)));
  lanes_.enough = static_cast<PieceLanes::Lanes>((1U << least) - 1U);
  const PieceLanes::Lanes touching = touching_lanes(*robot_, lanes_, lanes_.enough);
  if (touching == 0) return false;
  if ((touching & lanes_.enough) != 0) return true;
  const auto before = static_cast<unsigned>(std::countr_zero(touching));
  bound_bends();
  ask(queue_);
  lanes_.active = static_cast<PieceLanes::Lanes>((1U << before) - 1U);
  look(*robot_, lanes_);
  if ((lanes_.blocked & lanes_.enough) == 0)
    proved_share_ = std::min(share_in_front(), double(before) / first_cut);
  return true;
}

void EdgePieces::begin(const Configuration& from, const Configuration& to, int pieces) {
  from_ = &from;
  step_ = to - from;
  proved_share_ = 0.0;
  open_.clear();
  members_.clear();
  queue_.clear();
  for (int i = 0; i < pieces; ++i) queue_.push_back({double(i) / pieces, double(i + 1) / pieces, 0, -1});
  place(queue_);
}

/// At as many pieces of the queue as there are lanes; how many. What is blocked is found, nothing else
/// sorted.
std::size_t EdgePieces::look_at_next(std::size_t next) {
  const std::size_t count = std::min(queue_.size() - next, std::size_t{PieceLanes::count});
  asked_.assign(queue_.begin() + static_cast<std::ptrdiff_t>(next),
                queue_.begin() + static_cast<std::ptrdiff_t>(next + count));
  if (next > 0) place(asked_);
  ask(asked_);
  look(*robot_, lanes_);
  return count;
}

EdgePieces::Finding EdgePieces::examine(const Configuration& from, const Configuration& to,
                                        double least_share) {
  begin(from, to, first_cut);
  lanes_.all_or_nothing = false;
  if (is_touching(least_share)) return Finding::blocked;
  bound_bends();
  for (std::size_t next = 0; next < queue_.size();) {
    const std::size_t count = look_at_next(next);
    if (next == 0 && (lanes_.blocked & lanes_.enough) == 0) proved_share_ = share_in_front();
    if (lanes_.blocked != 0) return Finding::blocked;
    lanes_.enough = PieceLanes::Lanes(~0U);
    sort_out(asked_);
    next += count;
  }
  return open_.empty() ? Finding::free : Finding::open;
}

bool EdgePieces::is_free(const Configuration& from, const Configuration& to) {
  begin(from, to, quick_cut);
  bound_bends();
  lanes_.enough = PieceLanes::Lanes(~0U);
  lanes_.all_or_nothing = true;
  for (std::size_t next = 0; next < queue_.size() && open_.empty();) {
    next += look_at_next(next);
    if ((lanes_.blocked | lanes_.stuck) != 0) return false;
    sort_out(asked_);
  }
  return open_.empty();
}

/// The middles of the pieces, for all lanes.
void EdgePieces::place(std::span<const Piece> pieces) {
  lanes_.active = static_cast<PieceLanes::Lanes>((1U << pieces.size()) - 1U);
  lanes_.are_frames_placed = false;
  for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) {
    const Piece& piece = pieces[std::min(lane, pieces.size() - 1)];
    middle_.at[lane] = (piece.begin + piece.end) / 2;
    half_.at[lane] = (piece.end - piece.begin) / 2;
  }
  for (std::size_t j = 0; j < lanes_.q.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    row(lanes_.q[j]) = (*from_)[i] + row(middle_) * step_[i];
  }
}

/// How they move, and what is asked of them. Bounds are rounded, up or down, by less than they are too large.
void EdgePieces::ask(std::span<const Piece> pieces) {
  for (std::size_t j = 0; j < lanes_.q.size(); ++j)
    row(lanes_.step[j]) = row(half_) * step_[static_cast<Eigen::Index>(j)];
  PieceLanes::Floats half, squared;
  row(half) = row(half_).cast<float>();
  row(squared) = row(half_).square().cast<float>();
  const auto fill = [](const std::vector<float>& whole, PieceLanes::Floats& share,
                       std::vector<PieceLanes::Floats>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) row(rows[i]) = whole[i] * row(share);
  };
  fill(bend_, squared, lanes_.bend);
  fill(pair_bend_, squared, lanes_.pair_bend);
  fill(approach_, half, lanes_.approach);
  if (pieces[0].last < 0) return lanes_.want_all(static_cast<int>(pieces.size()));
  lanes_.want_none();
  for (std::size_t lane = 0; lane < pieces.size(); ++lane) {
    for (int i = pieces[lane].first; i < pieces[lane].last; ++i)
      lanes_.want(members_[static_cast<std::size_t>(i)], static_cast<int>(lane));
  }
}

/// Cuts what is not proved, or leaves it open.
void EdgePieces::sort_out(std::span<const Piece> pieces) {
  const unsigned failing_lanes = lanes_.failing();
  for (std::size_t lane = 0; lane < pieces.size(); ++lane) {
    if ((failing_lanes >> lane & 1U) == 0) continue;
    const int first = static_cast<int>(members_.size());
    for (const int member : lanes_.members) {
      if ((lanes_.failed[static_cast<std::size_t>(member)] >> lane & 1U) != 0) members_.push_back(member);
    }
    const int last = static_cast<int>(members_.size());
    const Piece& piece = pieces[lane];
    if ((lanes_.stuck >> lane & 1U) != 0 || queue_.size() >= most_pieces) {
      open_.push_back({piece.begin, piece.end, first, last});
      continue;
    }
    const double length = (piece.end - piece.begin) / further_cut;
    for (int i = 0; i < further_cut; ++i) {
      const double end = i + 1 == further_cut ? piece.end : piece.begin + (i + 1) * length;
      queue_.push_back({piece.begin + i * length, end, first, last});
    }
  }
}

}  // namespace clearway
