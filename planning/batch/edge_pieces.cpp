#include "planning/batch/edge_pieces.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace clearway {
namespace {

constexpr int first_cut = 16, further_cut = 4;
constexpr std::size_t most_pieces = 4096;

}  // namespace

/// Half of |x''| at most, over the whole edge: the second derivatives by two joints are turns of the way that
/// the later one moves the point (d^2 x / dq_i dq_k = z_i x dx / dq_k for i above k), so |x''| is at most
/// sum_i turn_i |d_i| (lever_i |d_i| + 2 sum_{k below i} lever_k |d_k|).
/// @param above joints of this frame and of its parents do not count.
double EdgePieces::bend_of(int frame, int above) const {
  double sum = 0.0, below = 0.0;
  const auto index = static_cast<std::size_t>(frame);
  for (int i = frame; i != above && i > 0; i = robot_->frames[static_cast<std::size_t>(i)].parent) {
    const auto mover = static_cast<std::size_t>(i);
    const double moved = robot_->lever_of(index, mover) * distance_[mover];
    if (robot_->frames[mover].turns) sum += distance_[mover] * (moved + 2.0 * below);
    below += moved;
  }
  return 0.5 * sum * (1.0 + 1e-5);
}

/// How far a ball's middle moves at most, whatever the configuration.
double EdgePieces::motion_of(int frame, int above) const {
  double sum = 0.0;
  for (int i = frame; i != above && i > 0; i = robot_->frames[static_cast<std::size_t>(i)].parent)
    sum += robot_->lever_of(static_cast<std::size_t>(frame), static_cast<std::size_t>(i)) *
           distance_[static_cast<std::size_t>(i)];
  return sum * (1.0 + 1e-5);
}

void EdgePieces::bound_bends() {
  distance_.assign(robot_->frames.size(), 0.0);
  for (std::size_t i = 1; i < robot_->frames.size(); ++i)
    distance_[i] = std::abs(robot_->frames[i].multiplier * step_[robot_->frames[i].joint]);
  bend_.clear();
  for (std::size_t i = 0; i < robot_->frames.size(); ++i) bend_.push_back(bend_of(static_cast<int>(i), 0));
  pair_bend_.clear();
  approach_.clear();
  for (const SphereRobot::FramePair& pair : robot_->frame_pairs) {
    pair_bend_.push_back(bend_of(pair.a, pair.meet) + bend_of(pair.b, pair.meet));
    approach_.push_back(motion_of(pair.a, pair.meet) + motion_of(pair.b, pair.meet));
  }
}

EdgePieces::Finding EdgePieces::examine(const Configuration& from, const Configuration& to) {
  from_ = &from;
  step_ = to - from;
  bound_bends();
  open_.clear();
  members_.clear();
  queue_.clear();
  for (int i = 0; i < first_cut; ++i)
    queue_.push_back({double(i) / first_cut, double(i + 1) / first_cut, 0, -1});
  for (std::size_t next = 0; next < queue_.size();) {
    const std::size_t count = std::min(queue_.size() - next, std::size_t{PieceLanes::count});
    std::array<Piece, PieceLanes::count> pieces;
    std::copy_n(queue_.begin() + static_cast<std::ptrdiff_t>(next), count, pieces.begin());
    next += count;
    const std::span<const Piece> asked(pieces.data(), count);
    ask(asked);
    look(*robot_, lanes_);
    if (next == count)
      proved_share_ = double(std::min(std::countr_zero(unsigned{lanes_.failing()}), first_cut)) / first_cut;
    if (lanes_.blocked != 0) return Finding::blocked;
    sort_out(asked);
  }
  return open_.empty() ? Finding::free : Finding::open;
}

void EdgePieces::ask(std::span<const Piece> pieces) {
  const std::size_t count = pieces.size();
  std::array<double, PieceLanes::count> middle{}, half{};
  for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) {
    const Piece& piece = pieces[std::min(lane, count - 1)];
    middle[lane] = (piece.begin + piece.end) / 2;
    half[lane] = (piece.end - piece.begin) / 2;
  }
  for (std::size_t j = 0; j < lanes_.q.size(); ++j) {
    const double start = (*from_)[static_cast<Eigen::Index>(j)], step = step_[static_cast<Eigen::Index>(j)];
    for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) {
      lanes_.q[j].at[lane] = start + middle[lane] * step;
      lanes_.step[j].at[lane] = half[lane] * step;
    }
  }
  std::array<double, PieceLanes::count> squared{};
  for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) squared[lane] = half[lane] * half[lane];
  const auto fill = [](const std::vector<double>& whole, const std::array<double, PieceLanes::count>& share,
                       std::vector<PieceLanes::Floats>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t lane = 0; lane < PieceLanes::count; ++lane)
        rows[i].at[lane] = static_cast<float>(whole[i] * share[lane]);
    }
  };
  fill(bend_, squared, lanes_.bend);
  fill(pair_bend_, squared, lanes_.pair_bend);
  fill(approach_, half, lanes_.approach);
  if (pieces[0].last < 0) return lanes_.want_all(static_cast<int>(count));
  lanes_.want_none();
  lanes_.active = static_cast<PieceLanes::Lanes>((1U << count) - 1U);
  for (std::size_t lane = 0; lane < count; ++lane) {
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
