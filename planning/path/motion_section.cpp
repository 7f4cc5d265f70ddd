#include "planning/path/motion_section.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "planning/path/section_drive.hpp"

namespace clearway {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double most_of_gravity = 0.99;  ///< of a torque limit that is kept
constexpr double nearly_all = 0.99;       ///< of what gravity leaves of torques: no more is tried
constexpr double spared = 0.998;          ///< of it, of which the next motion may take so much
constexpr double least_part = 0.1;        ///< of it: what takes less is not driven far harder at once
constexpr double least_drive = 1e-4;      ///< of acceleration limits
constexpr int most_halvings = 3;          ///< of a step of acceleration
constexpr int most_tries = 4;             ///< of motions, once one of them holds
constexpr double longest_sample = 0.008;  ///< s: torques are judged so often, between knots, too
constexpr int most_slowings = 60;

constexpr double least_reach = 1e-9;  ///< rad or m; of a shorter blend acceleration is rounding
constexpr double end_share = 1.6;     ///< as much more a blend may take of the first and of the last edge

/// Moments of a motion: all knots, and so many between them that none is farther from the next than 8 ms.
std::vector<MotionState> judged_states(const Motion& motion) {
  const int parts = std::max(1, static_cast<int>(std::ceil(motion.period / longest_sample - 1e-9)));
  std::vector<MotionState> states;
  for (std::size_t k = 0; k < motion.positions.size(); ++k) {
    states.push_back({motion.positions[k], motion.velocities[k], motion.accelerations[k], {}});
    for (int i = 1; i < parts && k + 1 < motion.positions.size(); ++i)
      states.push_back(motion.at(motion.period * (static_cast<double>(k) + static_cast<double>(i) / parts)));
  }
  return states;
}

/// The greatest share of a torque limit at any moment; not a number where a torque is none.
double torque_share(const Robot& robot, const Motion& motion, const TorqueTerms& terms,
                    const Eigen::VectorXd& limits) {
  double greatest = 0.0;
  for (const auto& [q, velocity, acceleration, jerk] : judged_states(motion)) {
    const double share = joint_torques(robot, q, velocity, acceleration, terms)
                             .cwiseAbs()
                             .cwiseQuotient(limits)
                             .maxCoeff<Eigen::PropagateNaN>();
    if (!(share <= greatest)) greatest = share;
    if (std::isnan(greatest)) break;
  }
  return greatest;
}

/// The limits of joints that hold what hangs on them with some to spare; the others have none.
Eigen::VectorXd limits_beside_gravity(const Robot& robot, const Motion& motion, const TorqueTerms& terms) {
  Eigen::VectorXd limits = terms.limits;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(limits.size());
  for (const auto& [q, velocity, acceleration, jerk] : judged_states(motion)) {
    const Eigen::VectorXd held = joint_torques(robot, q, rest, rest, terms).cwiseAbs();
    limits = (held.array() <= most_of_gravity * limits.array()).select(limits, no_limit);
  }
  return limits;
}

/// How much a motion takes of what gravity leaves of torque limits, at the moment when it is most.
double share_beside_gravity(const Robot& robot, const Motion& motion, const TorqueTerms& terms,
                            const Eigen::VectorXd& limits) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(limits.size());
  double greatest = 0.0;
  for (const auto& [q, velocity, acceleration, jerk] : judged_states(motion)) {
    const Eigen::ArrayXd held = joint_torques(robot, q, rest, rest, terms),
                         moved = joint_torques(robot, q, velocity, acceleration, terms).array() - held;
    const Eigen::ArrayXd most = (moved < 0.0).select(-limits.array() - held, limits.array() - held);
    greatest = std::max(greatest, (moved / most).maxCoeff());
  }
  return greatest;
}

/// Slows a section until its torques keep their limits. Keeps the shortest motion that holds.
class WithinTorques {
 public:
  /// @param section whose motion exceeds them
  WithinTorques(MotionSection& section, const Robot& robot, const RateLimits& limits,
                const SmoothMotionOptions& options)
      : section_(section),
        robot_(robot),
        limits_(limits),
        options_(options),
        most_(limits_beside_gravity(robot, section.motion, *options.torques)) {}

  void slow(bool chooses_drive) {
    if (taken() <= 1.0) return;
    const MotionDrive fastest = *section_.drive;
    torques_ = torques_along(section_.path, timed_stretches(section_.path), robot_, *options_.torques, most_);
    if (chooses_drive) section_.drive.reset();
    try {
      time_within_torques();
      lower_acceleration(fastest);
    } catch (const std::invalid_argument&) {  // too slow: what holds so far counts
      if (!best_) throw;
    }
    if (best_) take(std::move(*best_), options_.period, section_);
  }

 private:
  /// The greatest share of a torque limit.
  double taken() const { return torque_share(robot_, section_.motion, *options_.torques, most_); }

  /// Whether torques hold. Keeps what does and ends before the best.
  bool holds() {
    if (!(taken() <= 1.0)) return false;
    const DrivenSamples made{*section_.drive, section_.samples, section_.window};
    if (!best_ || made.periods() < best_->periods()) best_ = made;
    return true;
  }

  /// The path is timed within that share of torque limits with which the motion, averaged, takes most of
  /// them.
  void time_within_torques() {
    double share = 1.0, held = 0.0;
    for (int i = 0; i < most_slowings && (held == 0.0 || i < most_tries); ++i) {
      if (section_.drive) section_.drive->torque_share = share;
      drive_section(section_, limits_, options_.period, torques_, share);
      const double part = share_beside_gravity(robot_, section_.motion, *options_.torques, most_);
      if (holds()) {
        if (part > nearly_all) return;
        held = std::max(held, share);
      }
      const double next = share * spared / std::max(part, least_part);
      share = next > held ? next : 0.5 * (held + share);
    }
  }

  /// As averaging lowers torques, too, less acceleration alone may end earlier.
  void lower_acceleration(MotionDrive drive) {
    double exceeding = 1.0, held = 0.0;
    for (int halved = 0; halved < most_halvings && exceeding > least_drive;) {
      drive.share = held > 0.0 ? std::sqrt(held * exceeding) : exceeding / std::numbers::sqrt2;
      if (held > 0.0) ++halved;
      DrivenSamples made = driven(section_.path, limits_, drive, options_.period, torques_);
      if (best_ && made.samples.positions.size() + 1 >= best_->periods()) return;
      made.window = window_of(made, limits_, options_.period);
      take(std::move(made), options_.period, section_);
      (holds() ? held : exceeding) = drive.share;
    }
  }

  MotionSection& section_;
  const Robot& robot_;
  const RateLimits& limits_;
  const SmoothMotionOptions& options_;
  const Eigen::VectorXd most_;
  std::vector<StretchTorques> torques_;
  std::optional<DrivenSamples> best_;
};

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

void time_section(MotionSection& section, const Robot& robot, const RateLimits& limits,
                  const SmoothMotionOptions& options) {
  section.path = blended_path(section.waypoints, section.reach);
  const bool has_drive = section.drive.has_value();
  if (has_drive) section.drive->torque_share = 0.0, section.drive->share = 1.0;
  drive_section(section, limits, options.period, {}, 0.0);
  if (!options.torques || options.torques->limits.minCoeff() == no_limit) return;
  const double share = torque_share(robot, section.motion, *options.torques, options.torques->limits);
  if (!(share > 1.0 && std::isfinite(share))) return;  // the check refuses what is not finite
  WithinTorques(section, robot, limits, options).slow(!has_drive);
}

}  // namespace clearway
