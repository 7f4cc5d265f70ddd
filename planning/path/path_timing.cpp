#include "planning/path/path_timing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();
constexpr double least_nodes = 200.0;    ///< of a path
constexpr double longest_step = 0.02;    ///< between nodes, rad or m
constexpr double fewest_in_blend = 6.0;  ///< intervals
constexpr double most_samples_of_leg = 1e6, most_nodes_of_leg = 1e6;
constexpr double longest_level = 4.0;      ///< times what it should be
constexpr double safe_side = 1.0 - 1e-12;  ///< keeps what is computed on the safe side

/// A stretch between two nodes. x is the path speed squared, u the path acceleration: x' = x + 2 length u.
struct Stretch : PathStretch {
  const StretchTorques* torques = nullptr;
  double max_x = no_bound, max_u = 0.0;  ///< of x at both ends, and of |u| where the piece is straight
};

/// The interval of u, and how its bounds change with x.
struct Range {
  double low = -no_bound, high = no_bound, low_slope = 0.0, high_slope = 0.0;
};

class Timing {
 public:
  Timing(const SmoothPath& path, const Eigen::VectorXd& max_velocity, const Eigen::VectorXd& max_acceleration,
         double cruise, const TorqueShare& torques)
      : path_(path), velocity_(max_velocity), acceleration_(max_acceleration), share_(torques.share) {
    for (const PathStretch& stretch : timed_stretches(path)) {
      stretches_.push_back(bounded({stretch}));
      if (torques.along) stretches_.back().torques = &(*torques.along)[stretches_.size() - 1];
    }
    pass_backward();
    pass_forward();
    if (cruise > 0.0) level_peaks(cruise);
  }

  PathSamples sample(double period) const {
    std::vector<double> begins{0.0};
    for (std::size_t k = 0; k < stretches_.size(); ++k) begins.push_back(begins.back() + duration(k));
    const double periods = std::ceil(begins.back() / period);
    if (!(periods <= most_samples_of_leg))
      throw std::invalid_argument(
          "motion: it lasts more than a million samples, expected a shorter path or "
          "greater limits");
    PathSamples samples;
    std::size_t k = 0;
    for (double n = 0.0; n < periods; ++n) {
      const double time = n * period;
      while (k + 1 < stretches_.size() && time >= begins[k + 1]) ++k;
      samples.positions.push_back(position(k, time - begins[k]));
      samples.pieces.push_back(stretches_[k].piece);
    }
    samples.positions.front() = path_.begin;
    samples.positions.push_back(path_.end);
    samples.pieces.push_back(path_.pieces.size() - 1);
    return samples;
  }

 private:
  Stretch bounded(Stretch stretch) const {
    const PathPiece& piece = path_.pieces[stretch.piece];
    stretch.max_u = no_bound;
    for (Eigen::Index j = 0; j < velocity_.size(); ++j) {
      const double from = std::abs(piece.direction[j] + stretch.begin * piece.bend[j]);
      const double to = std::abs(piece.direction[j] + (stretch.begin + stretch.length) * piece.bend[j]);
      const double speed = velocity_[j] / std::max(from, to);
      stretch.max_x = std::min(stretch.max_x, speed * speed);
      stretch.max_u = std::min(stretch.max_u, acceleration_[j] / std::max(from, to));
    }
    stretch.max_x *= safe_side;
    stretch.max_u *= safe_side;
    return stretch;
  }

  /// Whether |u| <= max_u is all that binds u.
  bool is_simple(const Stretch& stretch) const {
    return path_.pieces[stretch.piece].is_straight() && !stretch.torques;
  }

  /// The greatest x at each node from which the end can be reached.
  void pass_backward() {
    x_.assign(stretches_.size() + 1, 0.0);
    for (std::size_t k = stretches_.size(); k-- > 0;) {
      const double before = k == 0 ? no_bound : stretches_[k - 1].max_x;
      x_[k] = highest_start(stretches_[k], std::min(before, stretches_[k].max_x), x_[k + 1]);
    }
  }

  void pass_forward() {
    x_[0] = 0.0;
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      const Stretch& stretch = stretches_[k];
      double u = stretch.max_u;
      if (!is_simple(stretch)) {
        const Range range = range_at(stretch, x_[k], x_[k + 1]);
        u = range.low <= range.high ? range.high : 0.5 * (range.low + range.high);
      }
      x_[k + 1] = std::clamp(x_[k] + 2.0 * stretch.length * u, 0.0, x_[k + 1]);
    }
  }

  /// Cuts off each peak of x so that the speed stays level for `cruise` seconds. Where it would be level for
  /// far longer the peak is kept: it is a brief one beside a long stretch, which would creep.
  void level_peaks(double cruise) {
    for (std::size_t k = 1; k + 1 < x_.size(); ++k) {
      if (!is_peak(k) || level_time(k, x_[k]) >= cruise) continue;
      double low = 0.0, high = x_[k];
      for (int step = 0; step < 40; ++step) {
        const double level = 0.5 * (low + high);
        (level_time(k, level) < cruise ? high : low) = level;
      }
      if (level_time(k, low) <= longest_level * cruise) level_peak(k, low);
    }
  }

  /// Whether x rises to node k, and falls after those that are level with it.
  bool is_peak(std::size_t k) const {
    if (!(x_[k] > x_[k - 1])) return false;
    std::size_t last = k;
    while (last + 1 < x_.size() && x_[last + 1] == x_[k]) ++last;
    return last + 1 < x_.size() && x_[last + 1] < x_[k];
  }

  /// Nodes about the peak k that are not below a level: the first and the last.
  std::pair<std::size_t, std::size_t> nodes_above(std::size_t k, double level) const {
    std::size_t first = k, last = k;
    while (first > 0 && x_[first - 1] >= level) --first;
    while (last + 1 < x_.size() && x_[last + 1] >= level) ++last;
    return {first, last};
  }

  /// How long the speed would be level if nothing about peak k were above the level, seconds.
  double level_time(std::size_t k, double level) const {
    const auto [first, last] = nodes_above(k, level);
    double length = 0.0;
    for (std::size_t i = first; i < last; ++i) length += stretches_[i].length;
    return length / std::sqrt(level);
  }

  /// Lowers the nodes above the level where limits allow it: a path acceleration nearer to 0 keeps them when
  /// 0 does, at the speed of both ends.
  void level_peak(std::size_t k, double level) {
    const auto [first, last] = nodes_above(k, level);
    if (!(level > 0.0) || first == 0 || last + 1 == x_.size()) return;
    for (std::size_t i = first - 1; i <= last; ++i) {
      const double most = std::max(std::min(x_[i], level), std::min(x_[i + 1], level));
      const Eigen::VectorXd& bend = path_.pieces[stretches_[i].piece].bend;
      if ((bend.cwiseAbs() * most - acceleration_ * safe_side).maxCoeff() > 0.0) return;
      if (const StretchTorques* torques = stretches_[i].torques)
        for (const TorqueBounds* at : {&torques->begin, &torques->end})
          if (((share_ * at->low).array() > at->across.array() * most).any() ||
              ((share_ * at->high).array() < at->across.array() * most).any())
            return;
    }
    for (std::size_t i = first; i <= last; ++i) x_[i] = level;
  }

  /// The greatest x <= max_x from which some u leads to at most `next`. In the plane of x and u the bounds
  /// form a convex polygon with the origin in it; from the right, Newton's steps along its sides end at the
  /// corner.
  double highest_start(const Stretch& stretch, double max_x, double next) const {
    if (is_simple(stretch)) return std::min(max_x, next + 2.0 * stretch.length * stretch.max_u);
    double x = max_x;
    const PathPiece& piece = path_.pieces[stretch.piece];
    for (Eigen::Index j = 0; j < velocity_.size(); ++j) {  // what u cannot mend: |bend| x <= a
      const double from = piece.direction[j] + stretch.begin * piece.bend[j];
      const double to = from + 3.0 * stretch.length * piece.bend[j];
      if (from == 0.0 || to == 0.0) x = std::min(x, acceleration_[j] / std::abs(piece.bend[j]));
    }
    for (int step = 0; step < 100; ++step) {
      const Range range = range_at(stretch, x, next);
      const double gap = range.high - range.low, slope = range.high_slope - range.low_slope;
      if (gap >= 0.0 || !(slope < 0.0)) break;
      x = std::max(0.0, x - gap / slope);
    }
    return x * safe_side;
  }

  /// Of u: every joint's acceleration at both ends of the stretch, and 0 <= x' <= next.
  Range range_at(const Stretch& stretch, double x, double next) const {
    const PathPiece& piece = path_.pieces[stretch.piece];
    Range range;
    const auto bound = [&](double p, double r, double low, double high) {  // low <= p u + r x <= high
      if (p == 0.0) return;
      if (p < 0.0) std::swap(low, high);
      const double upper = (high - r * x) / p, lower = (low - r * x) / p;
      if (upper < range.high) range.high = upper, range.high_slope = -r / p;
      if (lower > range.low) range.low = lower, range.low_slope = -r / p;
    };
    for (Eigen::Index j = 0; j < velocity_.size(); ++j) {
      const double bend = piece.bend[j], limit = acceleration_[j];
      const double from = piece.direction[j] + stretch.begin * bend;
      bound(from, bend, -limit, limit);
      bound(from + 3.0 * stretch.length * bend, bend, -limit, limit);  // to u + bend (x + 2 length u)
    }
    if (stretch.torques) {
      const auto& [begin, end] = *stretch.torques;
      for (Eigen::Index j = 0; j < begin.along.size(); ++j) {
        bound(begin.along[j], begin.across[j], share_ * begin.low[j], share_ * begin.high[j]);
        bound(end.along[j] + 2.0 * stretch.length * end.across[j], end.across[j], share_ * end.low[j],
              share_ * end.high[j]);
      }
    }
    bound(2.0 * stretch.length, 1.0, 0.0, next);
    return range;
  }

  double duration(std::size_t k) const {
    return 2.0 * stretches_[k].length / (std::sqrt(x_[k]) + std::sqrt(x_[k + 1]));
  }

  Configuration position(std::size_t k, double time) const {
    const Stretch& stretch = stretches_[k];
    const double u = (x_[k + 1] - x_[k]) / (2.0 * stretch.length);
    const double done = std::sqrt(x_[k]) * time + 0.5 * u * time * time;
    return path_.pieces[stretch.piece].at(stretch.begin + std::clamp(done, 0.0, stretch.length));
  }

  const SmoothPath& path_;
  const Eigen::VectorXd &velocity_, &acceleration_;
  const double share_;  ///< of torques
  std::vector<Stretch> stretches_;
  std::vector<double> x_;  ///< at each node
};

}  // namespace

std::vector<PathStretch> timed_stretches(const SmoothPath& path) {
  const double step = std::min(longest_step, path.length() / least_nodes);
  if (path.length() > most_nodes_of_leg * step)
    throw std::invalid_argument("motion: a leg is longer than " + short_text(most_nodes_of_leg * step) +
                                " rad or m, expected a shorter path");
  std::vector<PathStretch> stretches;
  for (std::size_t i = 0; i < path.pieces.size(); ++i) {
    const PathPiece& piece = path.pieces[i];
    const double fewest = piece.is_straight() ? 1.0 : fewest_in_blend;
    const double count = std::max(fewest, std::ceil(piece.length / step));
    for (double k = 0.0; k < count; ++k)
      stretches.push_back({i, piece.length * (k / count), piece.length / count});
  }
  return stretches;
}

PathSamples time_optimal_samples(const SmoothPath& path, const Eigen::VectorXd& max_velocity,
                                 const Eigen::VectorXd& max_acceleration, double period, double cruise,
                                 const TorqueShare& torques) {
  return Timing(path, max_velocity, max_acceleration, cruise, torques).sample(period);
}

}  // namespace clearway
