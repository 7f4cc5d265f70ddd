#include "planning/path/motion_section.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

using Waypoints = std::vector<Configuration>;

constexpr std::array<MotionDrive, 8> drives = {{{1.0, false},
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
  if (!(enough <= most_terms))
    throw std::invalid_argument("motion: jerk limits are so low that acceleration builds up over " +
                                short_text(enough) + " periods, expected greater ones");
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

void time_once(MotionSection& section, const RateLimits& limits, double period) {
  section.path = blended_path(section.waypoints, section.reach);
  MotionDrive chosen;
  const double rise = limits.acceleration.cwiseQuotient(limits.jerk).maxCoeff();
  const auto drive = [&](const MotionDrive& as) {
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
    for (const MotionDrive& as : drives) try {
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

}  // namespace

MotionSection section_of(std::vector<Configuration> waypoints, double share) {
  MotionSection section;
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

MotionSection part_of(const MotionSection& whole, std::size_t first, std::size_t last) {
  MotionSection part;
  const auto copy = [&](const auto& from, auto& to) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  };
  copy(whole.waypoints, part.waypoints);
  copy(whole.reach, part.reach);
  copy(whole.halved, part.halved);
  return part;
}

void time_section(MotionSection& section, const Robot& robot, RateLimits limits,
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

}  // namespace clearway
