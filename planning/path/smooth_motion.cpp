#include "planning/path/smooth_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"
#include "planning/path/path_timing.hpp"
#include "planning/path/smooth_path.hpp"

namespace clearway {
namespace {

using Waypoints = std::vector<Configuration>;

/// How hard a motion is driven before it is averaged: less acceleration, and a level speed between
/// acceleration and braking, need a shorter window for the same jerk.
struct Drive {
  double share = 1.0;  ///< of the acceleration limit
  bool is_level = false;
};
constexpr std::array<Drive, 8> drives = {{{1.0, false},
                                          {1.0, true},
                                          {0.7, false},
                                          {0.7, true},
                                          {0.5, false},
                                          {0.5, true},
                                          {0.35, false},
                                          {0.35, true}}};

constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double most_of_gravity = 0.99;  ///< of a torque limit that is kept
constexpr double slowing = 0.9;           ///< of speeds, where torques are too great
constexpr double most_terms = 2e8;        ///< of all means over windows
constexpr int most_slowings = 60;

constexpr double least_reach = 1e-9;  ///< rad or m; of a shorter blend acceleration is rounding
constexpr double end_share = 1.6;     ///< as much more a blend may take of the first and of the last edge

/// A motion from rest to rest. Control point i is the mean of samples i - 1 - window to i - 2, knot i stands
/// at control point i + 1; what lies before the first sample and after the last rests.
struct Section {
  Waypoints waypoints;
  std::vector<double> reach;  ///< of each waypoint
  std::vector<int> halved;    ///< how often
  SmoothPath path;
  PathSamples samples;
  std::size_t window = 1;
  std::optional<Drive> drive;  ///< once it is chosen
  Waypoints control;
  Motion motion;

  std::size_t clamped(std::ptrdiff_t sample) const {
    const auto last = static_cast<std::ptrdiff_t>(samples.positions.size()) - 1;
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(sample, 0, last));
  }
  std::size_t piece_of(std::ptrdiff_t sample) const { return samples.pieces[clamped(sample)]; }
  /// The first and last piece of the path that the motion between knots i and i + 1 is made of.
  std::pair<std::size_t, std::size_t> pieces_of(std::size_t i) const {
    const auto k = static_cast<std::ptrdiff_t>(i);
    return {piece_of(k - 1 - static_cast<std::ptrdiff_t>(window)), piece_of(k + 1)};
  }
  /// Whether the motion between knots i and i + 1 lies on one edge.
  bool is_on_edge(std::size_t i) const {
    const auto [first, last] = pieces_of(i);
    return first == last && path.pieces[first].is_straight();
  }
};

void require_sound(const ConfigurationSpace& space, const std::vector<Waypoints>& legs,
                   const SmoothMotionOptions& options) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("motion: " + what); };
  if (!(std::isfinite(options.period) && options.period > 0.0))
    refuse("period is " + short_text(options.period) + ", expected seconds above 0");
  if (!(std::isfinite(options.straighten) && options.straighten >= 0.0))
    refuse("straighten is " + short_text(options.straighten) + ", expected a length not below 0");
  if (!(options.reach >= 0.0 && options.reach <= 0.5))
    refuse("reach is " + short_text(options.reach) + ", expected a share from 0 to 0.5");
  if (options.halvings < 0) refuse("halvings is below 0, expected a number of halvings");
  const bool has_torques = options.torques != nullptr;
  if (has_torques && (options.torques->inertia.size() != space.robot().links.size() ||
                      options.torques->limits.size() != static_cast<Eigen::Index>(space.robot().dof()) ||
                      !(options.torques->limits.minCoeff() > 0.0)))
    refuse("torques are not those of the robot, expected an inertia for each link and limits above 0");
  if (legs.empty()) refuse("the path has no legs");
  const auto dof = static_cast<Eigen::Index>(space.robot().dof());
  for (std::size_t i = 0; i < legs.size(); ++i) {
    if (legs[i].empty()) refuse("leg " + std::to_string(i) + " has no waypoints");
    for (const Configuration& q : legs[i])
      if (q.size() != dof || !q.allFinite())
        refuse("a waypoint of leg " + std::to_string(i) + " is not of " + std::to_string(dof) +
               " finite joint values");
    if (i > 0 && legs[i].front() != legs[i - 1].back())
      refuse("leg " + std::to_string(i) + " does not begin where the one before it ends");
  }
}

// --- 1. The path ---

/// Where no joint of `q` is farther from than from other places of the edge, about: the nearest place.
Configuration nearest_on(const Configuration& from, const Configuration& to, const Configuration& q) {
  const Eigen::VectorXd step = to - from;
  const double length = step.squaredNorm();
  return length > 0.0 ? (from + std::clamp(step.dot(q - from) / length, 0.0, 1.0) * step).eval() : from;
}

/// Whether the edge between them has a length that is not rounded to 0.
bool is_apart(const Configuration& a, const Configuration& b) { return (a - b).squaredNorm() > 0.0; }

class Straightener {
 public:
  Straightener(const ConfigurationSpace& space, const Waypoints& path, double tolerance)
      : space_(space), path_(path), tolerance_(tolerance) {}

  Waypoints run() const {
    Waypoints kept{path_.front()};
    for (std::size_t i = 0; i + 1 < path_.size();) {
      i = farthest_from(i);
      kept.push_back(path_[i]);
    }
    return kept;
  }

 private:
  /// A waypoint that can follow waypoint i: by doubled steps while they are certified, then by halved ones.
  std::size_t farthest_from(std::size_t i) const {
    const std::size_t last = path_.size() - 1;
    std::size_t good = i + 1, bad = last + 1;
    for (std::size_t step = 2; good < last && good + 1 < bad; step *= 2) {
      const std::size_t next = std::min(i + step, last);
      (can_skip(i, next) ? good : bad) = next;
      if (bad == next) break;
    }
    while (good + 1 < bad && bad <= last) {
      const std::size_t middle = good + (bad - good) / 2;
      (can_skip(i, middle) ? good : bad) = middle;
    }
    return good;
  }

  bool can_skip(std::size_t from, std::size_t to) const {
    for (std::size_t i = from + 1; i < to; ++i) {
      const Configuration there = nearest_on(path_[from], path_[to], path_[i]);
      if ((path_[i] - there).cwiseAbs().maxCoeff() > tolerance_) return false;
    }
    return is_apart(path_[from], path_[to]) && space_.is_edge_free(path_[from], path_[to]);
  }

  const ConfigurationSpace& space_;
  const Waypoints& path_;
  double tolerance_;
};

Waypoints without_doubles(const Waypoints& path) {
  Waypoints kept{path.front()};
  for (const Configuration& q : path)
    if (is_apart(q, kept.back())) kept.push_back(q);
  return kept;
}

Section section_of(Waypoints waypoints, double share) {
  Section section;
  section.reach.assign(waypoints.size(), 0.0);
  section.halved.assign(waypoints.size(), 0);
  const std::size_t last = waypoints.size() - 1;
  for (std::size_t i = 1; i < last; ++i) {  // the first and the last edge have one blend each
    const double in = (waypoints[i] - waypoints[i - 1]).norm(),
                 out = (waypoints[i + 1] - waypoints[i]).norm();
    const double reach =
        share * std::min(i == 1 ? end_share * in : in, i + 1 == last ? end_share * out : out);
    section.reach[i] = reach < least_reach ? 0.0 : reach;
  }
  section.waypoints = std::move(waypoints);
  return section;
}

/// The waypoints from `first` to `last` with what is known of their blends.
Section part_of(const Section& whole, std::size_t first, std::size_t last) {
  Section part;
  const auto copy = [&](const auto& from, auto& to) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  };
  copy(whole.waypoints, part.waypoints);
  copy(whole.reach, part.reach);
  copy(whole.halved, part.halved);
  return part;
}

// --- 2 and 3. Time ---

/// The least window that was found over which acceleration changes by no more than jerk allows: by the second
/// differences of the samples, at rest before and after.
std::size_t least_window(const Waypoints& samples, const RateLimits& limits, double period) {
  const Eigen::Index n = samples.front().size();
  const std::size_t count = samples.size() + 2;
  Eigen::MatrixXd second(n, static_cast<Eigen::Index>(count));
  const auto sample = [&](std::size_t k) -> const Configuration& {
    return samples[std::min(k > 1 ? k - 2 : 0, samples.size() - 1)];  // sample k - 2, at rest outside
  };
  for (std::size_t k = 0; k < count; ++k)
    second.col(static_cast<Eigen::Index>(k)) =
        ((sample(k + 2) - sample(k + 1)) - (sample(k + 1) - sample(k))).cwiseQuotient(limits.jerk) /
        (period * period * period);
  const double enough = 2.0 * second.cwiseAbs().maxCoeff();
  for (std::size_t window = 1;;) {
    const auto w = std::min(static_cast<Eigen::Index>(window), second.cols());
    double most =
        std::max(second.leftCols(w).cwiseAbs().maxCoeff(), second.rightCols(w).cwiseAbs().maxCoeff());
    if (w < second.cols())
      most = std::max(
          most,
          (second.rightCols(second.cols() - w) - second.leftCols(second.cols() - w)).cwiseAbs().maxCoeff());
    const auto kept = static_cast<double>(window) * (1.0 + 1e-12);
    if (most <= kept || enough <= kept) return window;
    window = std::max(window + 1 + window / 64, static_cast<std::size_t>(0.5 * most));
  }
}

Waypoints averaged(const Waypoints& samples, std::size_t window) {
  const auto last = static_cast<std::ptrdiff_t>(samples.size()) - 1;
  const auto w = static_cast<std::ptrdiff_t>(window);
  if (static_cast<double>(w) * static_cast<double>(w + last) > most_terms)
    throw std::invalid_argument("motion: jerk limits are so low that acceleration builds up over " +
                                std::to_string(window) + " periods, expected greater ones");
  Waypoints control;
  for (std::ptrdiff_t c = -2; c <= last + w + 1; ++c) {
    const auto sample = [&](std::ptrdiff_t k) -> const Configuration& {
      return samples[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
    };
    const Configuration& newest = sample(c);
    Configuration offset = Configuration::Zero(newest.size());
    for (std::ptrdiff_t k = c - w + 1; k < c; ++k) offset += sample(k) - newest;
    control.push_back(newest + offset / static_cast<double>(window));
  }
  return control;
}

void time_once(Section& section, const RateLimits& limits, double period) {
  section.path = blended_path(section.waypoints, section.reach);
  Drive chosen;
  const double rise = limits.acceleration.cwiseQuotient(limits.jerk).maxCoeff();
  const auto drive = [&](const Drive& as) {
    PathSamples samples = time_optimal_samples(section.path, limits.velocity, as.share * limits.acceleration,
                                               period, as.is_level ? as.share * rise + 2.0 * period : 0.0);
    const std::size_t window = least_window(samples.positions, limits, period);
    const bool is_first = section.samples.positions.empty();
    if (!is_first && samples.positions.size() + window >= section.samples.positions.size() + section.window)
      return;
    section.samples = std::move(samples);
    section.window = window;
    chosen = as;
  };
  section.samples = {};
  if (section.drive) {
    drive(*section.drive);
  } else {
    for (const Drive& as : drives) try {
        drive(as);
      } catch (const std::invalid_argument&) {  // too slow: no matter where another is not
        if (section.samples.positions.empty()) throw;
      }
  }
  section.drive = chosen;
  section.control = averaged(section.samples.positions, section.window);
  section.motion = spline_motion(section.control, period);
  Configuration lowest = section.waypoints.front(), highest = lowest;
  for (const Configuration& q : section.waypoints) {
    lowest = lowest.cwiseMin(q);
    highest = highest.cwiseMax(q);
  }
  for (Configuration& q : section.motion.positions) q = q.cwiseMax(lowest).cwiseMin(highest);  // rounding
}

/// The greatest share of a torque limit at any knot; not a number where a torque is none.
double torque_share(const Robot& robot, const Motion& motion, const TorqueTerms& terms,
                    const Eigen::VectorXd& limits) {
  double greatest = 0.0;
  for (std::size_t k = 0; k < motion.positions.size() && !std::isnan(greatest); ++k) {
    const double share =
        joint_torques(robot, motion.positions[k], motion.velocities[k], motion.accelerations[k], terms)
            .cwiseAbs()
            .cwiseQuotient(limits)
            .maxCoeff<Eigen::PropagateNaN>();
    if (!(share <= greatest)) greatest = share;
  }
  return greatest;
}

/// The limits of joints that hold what hangs on them with some to spare; the others have none.
Eigen::VectorXd limits_beside_gravity(const Robot& robot, const Motion& motion, const TorqueTerms& terms) {
  Eigen::VectorXd limits = terms.limits;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(limits.size());
  for (const Configuration& q : motion.positions) {
    const Eigen::VectorXd held = joint_torques(robot, q, rest, rest, terms).cwiseAbs();
    limits = (held.array() <= most_of_gravity * limits.array()).select(limits, no_limit);
  }
  return limits;
}

/// Slower until torques keep their limits, too.
void time_section(Section& section, const Robot& robot, RateLimits limits,
                  const SmoothMotionOptions& options) {
  time_once(section, limits, options.period);
  if (!options.torques || options.torques->limits.minCoeff() == no_limit) return;
  const TorqueTerms& terms = *options.torques;
  const double share = torque_share(robot, section.motion, terms, terms.limits);
  if (share <= 1.0 || !std::isfinite(share)) return;  // the check refuses what is not finite
  const Eigen::VectorXd torques = limits_beside_gravity(robot, section.motion, terms);
  for (int i = 0; i < most_slowings; ++i) {
    if (torque_share(robot, section.motion, terms, torques) <= 1.0) return;
    limits.velocity *= slowing;
    limits.acceleration *= slowing * slowing;
    time_once(section, limits, options.period);
  }
}

// --- 4. The proof ---

/// Proves the motion of a section between knots.
class SplineProof {
 public:
  SplineProof(const ConfigurationSpace& space, const SmoothMotionOptions& options, const Section& section)
      : space_(space), options_(options), section_(section) {}

  /// The first stretches between two knots that are not proved, at most one of each run of stretches that
  /// leave the edges.
  std::vector<std::size_t> unproved() const {
    std::vector<std::size_t> found;
    const std::size_t stretches = section_.motion.positions.size() - 1;
    for (std::size_t begin = 0; begin < stretches;) {
      std::size_t end = begin;
      while (end < stretches && !section_.is_on_edge(end)) ++end;
      if (end > begin) {
        const std::size_t first = first_unproved(begin, end);
        if (first < end) found.push_back(first);
      }
      begin = end + 1;
    }
    return found;
  }

 private:
  /// The first stretch from `begin` on that is not proved, or `end`.
  std::size_t first_unproved(std::size_t begin, std::size_t end) const {
    const Configuration &from = section_.motion.positions[begin], &to = section_.motion.positions[end];
    const Eigen::VectorXd aside = deviation(begin, end);
    const bool is_slim = space_.motion_bound(aside) <= space_.map().resolution();
    if ((is_slim || end == begin + 1) && is_free(from, to, aside)) return end;
    if (end == begin + 1) return begin;
    const std::size_t middle = begin + (end - begin) / 2;
    const std::size_t first = first_unproved(begin, middle);
    return first < middle ? first : first_unproved(middle, end);
  }

  bool is_free(const Configuration& from, const Configuration& to, const Eigen::VectorXd& aside) const {
    return options_.is_tube_free ? options_.is_tube_free(from, to, aside)
                                 : space_.is_edge_free(from, to, aside);
  }

  /// How far joints are from the chord at most: by the control points of the cubics (Bezier).
  Eigen::VectorXd deviation(std::size_t begin, std::size_t end) const {
    const Configuration &from = section_.motion.positions[begin], &to = section_.motion.positions[end];
    Eigen::VectorXd most = Eigen::VectorXd::Zero(from.size());
    const auto widen = [&](const Configuration& q) {
      most = most.cwiseMax((q - nearest_on(from, to, q)).cwiseAbs());
    };
    for (std::size_t i = begin; i < end; ++i) {
      const Configuration &first = section_.control[i + 1], &second = section_.control[i + 2];
      if (i > begin) widen(section_.motion.positions[i]);
      widen(first + (second - first) / 3.0);
      widen(second + (first - second) / 3.0);
    }
    return (most.array() * (1.0 + 1e-9) + 1e-12).matrix();
  }

  const ConfigurationSpace& space_;
  const SmoothMotionOptions& options_;
  const Section& section_;
};

/// The waypoints whose blends make the motion after knot i: of the one in the middle of its window, if there
/// is one, else of all.
std::set<std::size_t> blends_at(const Section& section, std::size_t i) {
  const auto middle = static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(section.window) / 2;
  const PathPiece& at_middle = section.path.pieces[section.piece_of(middle)];
  if (!at_middle.is_straight()) return {at_middle.corner};
  const auto [first, last] = section.pieces_of(i);
  std::set<std::size_t> corners;
  for (std::size_t piece = first; piece <= last; ++piece)
    if (!section.path.pieces[piece].is_straight()) corners.insert(section.path.pieces[piece].corner);
  return corners;
}

/// The motion of one leg.
class LegMotion {
 public:
  LegMotion(const ConfigurationSpace& space, const RateLimits& limits, const SmoothMotionOptions& options)
      : space_(space), limits_(limits), options_(options) {}

  /// From stop to stop.
  void run(const Section& section, SmoothMotion& result) const {
    const std::size_t last = section.waypoints.size() - 1;
    for (std::size_t begin = 0; begin < last;) {
      const std::size_t end = next_stop(section, begin);
      if (end < last) ++result.stops;
      run_between_stops(part_of(section, begin, end), result);
      begin = end;
    }
  }

 private:
  void run_between_stops(Section section, SmoothMotion& result) const {
    const std::size_t last = section.waypoints.size() - 1;
    for (;;) {
      time_section(section, space_.robot(), limits_, options_);
      std::set<std::size_t> blamed;
      for (const std::size_t i : SplineProof(space_, options_, section).unproved())
        blamed.merge(blends_at(section, i));
      if (blamed.empty()) break;
      for (const std::size_t corner : blamed) {
        section.reach[corner] =
            ++section.halved[corner] <= options_.halvings ? 0.5 * section.reach[corner] : 0.0;
      }
      if (next_stop(section, 0) == last) continue;
      section = part_of(section, 0, last);  // without its samples
      return run(section, result);
    }
    result.blended += section.waypoints.size() - 2;
    append(result.motion, section.motion);
  }

  /// The first waypoint after `begin` without a blend, or the last.
  static std::size_t next_stop(const Section& section, std::size_t begin) {
    std::size_t i = begin + 1;
    while (i + 1 < section.waypoints.size() && section.reach[i] != 0.0) ++i;
    return i;
  }

  const ConfigurationSpace& space_;
  const RateLimits& limits_;
  const SmoothMotionOptions& options_;
};

}  // namespace

SmoothMotion smooth_motion(const ConfigurationSpace& space,
                           const std::vector<std::vector<Configuration>>& legs,
                           const SmoothMotionOptions& options) {
  require_sound(space, legs, options);
  const RateLimits limits = rate_limits(space.robot(), options.scales);
  const Configuration& start = legs.front().front();
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(start.size());
  SmoothMotion result{.motion = {options.period, {start}, {rest}, {rest}}, .leg_ends = {}};
  for (const Waypoints& leg : legs) {
    const Waypoints path = without_doubles(leg);
    if (path.size() > 1) {
      Waypoints kept = options.straighten > 0.0 ? Straightener(space, path, options.straighten).run() : path;
      result.straightened += path.size() - kept.size();
      LegMotion(space, limits, options).run(section_of(std::move(kept), options.reach), result);
    }
    result.leg_ends.push_back(result.motion.positions.size() - 1);
  }
  return result;
}

}  // namespace clearway
