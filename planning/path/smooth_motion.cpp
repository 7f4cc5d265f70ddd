#include "planning/path/smooth_motion.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/path/motion_section.hpp"
#include "planning/path/straightened_path.hpp"

namespace clearway {
namespace {

using Waypoints = std::vector<Configuration>;

constexpr double most_jerk_time = 60.0;  ///< s: of a leg, by jerk alone

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
      if (q.size() != dof || !q.allFinite() || (q.array().abs() > largest_joint_value).any())
        refuse("a waypoint of leg " + std::to_string(i) + " is not of " + std::to_string(dof) +
               " joint values of at most " + short_text(largest_joint_value));
    if (i > 0 && legs[i].front() != legs[i - 1].back())
      refuse("leg " + std::to_string(i) + " does not begin where the one before it ends");
  }
}

/// How far each joint goes along a leg at least, forth and back: blends pass a waypoint at half of its way
/// from the start or beyond, if it is not left out (SmoothMotionOptions::straighten).
Eigen::VectorXd least_way(const Waypoints& leg, double straighten) {
  const Configuration whole = leg.back() - leg.front();
  Eigen::VectorXd way = whole.cwiseAbs();
  for (const Configuration& q : leg) {
    const Configuration half = 0.5 * (q - leg.front());
    way = way.cwiseMax(((half.cwiseAbs() + (whole - half).cwiseAbs()).array() - 2.0 * straighten).matrix());
  }
  return way;
}

/// Refuses, before the work, jerk limits by which a leg takes more than most_jerk_time: from rest to rest a
/// joint goes jerk t^3 / 24 at most in the time t.
void require_sensible_jerk(const Robot& robot, const Waypoints& leg, const RateLimits& limits,
                           const SmoothMotionOptions& options) {
  Eigen::Index joint = 0;
  const double least =
      std::cbrt(24.0 * least_way(leg, options.straighten).cwiseQuotient(limits.jerk).maxCoeff(&joint));
  if (!(least > most_jerk_time)) return;
  const double jerk_scale = options.scales.jerk;
  const double enough = jerk_scale * std::pow(least / most_jerk_time, 3);
  const std::string takes = "a leg takes more than " + short_text(least, 3) + " s";
  if (enough <= 1.0)
    throw std::invalid_argument("motion: with the jerk scale " + short_text(jerk_scale) + " " + takes +
                                ", expected at least " + short_text(std::min(1.0, enough * 1.1), 2) +
                                ", by which " + short_text(most_jerk_time) + " s may do");
  throw std::invalid_argument("motion: the jerk limit of joint " +
                              quote(robot.joints[static_cast<std::size_t>(joint)].name) + ", " +
                              short_text(limits.jerk[joint]) + ", is so low that " + takes + ", expected " +
                              short_text(most_jerk_time) + " s at most");
}

/// Proves the motion of a section between knots.
class SplineProof {
 public:
  SplineProof(const ConfigurationSpace& space, const SmoothMotionOptions& options,
              const MotionSection& section)
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
  const MotionSection& section_;
};

/// The waypoints whose blends make the motion after knot i: of the one in the middle of its window, if there
/// is one, else of all.
std::set<std::size_t> blends_at(const MotionSection& section, std::size_t i) {
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
  void run(const MotionSection& section, SmoothMotion& result) const {
    const std::size_t last = section.waypoints.size() - 1;
    for (std::size_t begin = 0; begin < last;) {
      const std::size_t end = next_stop(section, begin);
      if (end < last) ++result.stops;
      run_between_stops(part_of(section, begin, end), result);
      begin = end;
    }
  }

 private:
  void run_between_stops(MotionSection section, SmoothMotion& result) const {
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
  static std::size_t next_stop(const MotionSection& section, std::size_t begin) {
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
  for (const Waypoints& leg : legs) require_sensible_jerk(space.robot(), leg, limits, options);
  for (const Waypoints& leg : legs) {
    const Waypoints path = without_doubles(leg);
    if (path.size() > 1) {
      Waypoints kept = options.straighten > 0.0 ? straightened(space, path, options.straighten) : path;
      result.straightened += path.size() - kept.size();
      LegMotion(space, limits, options).run(section_of(std::move(kept), options.reach), result);
    }
    result.leg_ends.push_back(result.motion.positions.size() - 1);
  }
  return result;
}

}  // namespace clearway
