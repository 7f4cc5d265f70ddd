#include "planning/path/section_drive.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

using Waypoints = std::vector<Configuration>;

constexpr double most_terms = 2e8;  // of all means over windows

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

/// Refuses, before the work, jerk with which no joint gets as far as the waypoints are from the first within
/// 20,000 periods: from rest it goes jerk t^3 / 6 in the time t.
void require_enough_jerk(const Waypoints& waypoints, const RateLimits& limits, double period) {
  constexpr double most_periods = 2e4;
  double least = 0.0;
  for (const Configuration& q : waypoints)
    least = std::max(
        least, std::cbrt(6.0 * (q - waypoints.front()).cwiseAbs().cwiseQuotient(limits.jerk).maxCoeff()));
  if (!(least <= most_periods * period))
    throw std::invalid_argument("motion: jerk limits are so low that the motion takes more than " +
                                short_text(least, 3) + " s, expected greater ones");
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

/// The longest that acceleration takes to build up, seconds.
double longest_rise(const RateLimits& limits) {
  return limits.acceleration.cwiseQuotient(limits.jerk).maxCoeff();
}

/// The drive of a section that ends first. Acceleration that is lower than its limit may end earlier where it
/// builds up slowly: rises of powers of the fourth root of 2 below the longest are tried, until the path
/// alone takes longer than the best, then those between the best and its neighbours. Wider limits only add to
/// what is tried.
class FastestDrive {
 public:
  FastestDrive(const SmoothPath& path, const RateLimits& limits, double period,
               const std::vector<StretchTorques>& torques, double torque_share)
      : path_(path),
        limits_(limits),
        period_(period),
        longest_(longest_rise(limits)),
        torques_(torques),
        torque_share_(torque_share) {}

  /// @throws std::invalid_argument what refuses the greatest acceleration, where nothing lower helps
  DrivenSamples find() {
    for (int eighths = 0; eighths <= most_eighths && !is_slow_; eighths += step()) attempt(eighths);
    if (!best_) throw *refusal_;
    const int best = best_at_;
    for (const int near : {best - 1, best + 1})
      if (near > 0) attempt(near);
    return std::move(*best_);
  }

 private:
  static constexpr int most_eighths = 400;

  /// Far more where the window is most of the motion, or nothing is known yet.
  int step() const {
    if (!best_) return 8;
    const double excess =
        static_cast<double>(best_->window) / static_cast<double>(best_->samples.positions.size());
    return excess > 4.0 ? 8 * static_cast<int>(std::log2(0.5 * excess)) : 2;
  }

  /// A rise of 2^(-eighths / 8) times the longest.
  void attempt(int eighths) {
    is_slow_ = best_.has_value();
    for (const bool is_level : {false, true}) try {
        const MotionDrive drive{longest_ * std::exp2(-0.125 * eighths), is_level, 1.0, torque_share_};
        DrivenSamples made = driven(path_, limits_, drive, period_, torques_);
        if (best_ && made.samples.positions.size() + 1 >= best_->periods()) continue;
        is_slow_ = false;
        made.window = window_of(made, limits_, period_);
        if (best_ && made.periods() >= best_->periods()) continue;
        best_ = std::move(made);
        best_at_ = eighths;
      } catch (const std::invalid_argument& error) {  // too slow: no matter where another is not
        if (!refusal_) refusal_ = error;
      }
  }

  const SmoothPath& path_;
  const RateLimits& limits_;
  const double period_, longest_;
  const std::vector<StretchTorques>& torques_;
  const double torque_share_;
  std::optional<DrivenSamples> best_;
  int best_at_ = 0;
  bool is_slow_ = false;  ///< what was tried last, on the path alone
  std::optional<std::invalid_argument> refusal_;
};

}  // namespace

DrivenSamples driven(const SmoothPath& path, const RateLimits& limits, const MotionDrive& drive,
                     double period, const std::vector<StretchTorques>& torques) {
  const Eigen::VectorXd acceleration = (drive.share * limits.acceleration).cwiseMin(drive.rise * limits.jerk);
  const double level = drive.is_level ? std::min(drive.rise, longest_rise(limits)) + 2.0 * period : 0.0;
  const TorqueShare share{drive.torque_share > 0.0 ? &torques : nullptr, drive.torque_share};
  return {drive, time_optimal_samples(path, limits.velocity, acceleration, period, level, share)};
}

std::size_t window_of(const DrivenSamples& made, const RateLimits& limits, double period) {
  return least_window(made.samples.positions, limits, period);
}

void take(DrivenSamples made, double period, MotionSection& section) {
  section.drive = made.drive;
  section.samples = std::move(made.samples);
  section.window = made.window;
  section.control = averaged(section.samples.positions, section.window);
  section.motion = spline_motion(section.control, period);
  Configuration lowest = section.waypoints.front(), highest = lowest;
  for (const Configuration& q : section.waypoints) {
    lowest = lowest.cwiseMin(q);
    highest = highest.cwiseMax(q);
  }
  for (Configuration& q : section.motion.positions) q = q.cwiseMax(lowest).cwiseMin(highest);  // rounding
}

void drive_section(MotionSection& section, const RateLimits& limits, double period,
                   const std::vector<StretchTorques>& torques, double torque_share) {
  require_enough_jerk(section.waypoints, limits, period);
  if (!section.drive) {
    take(FastestDrive(section.path, limits, period, torques, torque_share).find(), period, section);
    return;
  }
  DrivenSamples made = driven(section.path, limits, *section.drive, period, torques);
  made.window = window_of(made, limits, period);
  take(std::move(made), period, section);
}

}  // namespace clearway
