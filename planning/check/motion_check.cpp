#include "planning/check/motion_check.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {
namespace {

constexpr double excess = 1e-6;          ///< share of a limit that rounding may take
constexpr double rounded_away = 1e-9;    ///< rad or m: of positions
constexpr double sample_period = 0.001;  ///< seconds, at most
constexpr double longest = 43200.0;      ///< seconds: more is not sampled
constexpr double widest_tube = 5e-4;     ///< rad or m of a joint, where one chord stands for several cubics

/// The cubic between two knots.
class Cubic {
 public:
  Cubic(const Motion& motion, std::size_t k)
      : h_(motion.period),
        p0_(motion.positions[k]),
        p1_(motion.positions[k + 1]),
        v0_(motion.velocities[k]),
        v1_(motion.velocities[k + 1]) {}

  /// At a share of the period, 0 to 1: the Hermite basis and its derivatives.
  Eigen::VectorXd position(double s) const {
    const double r = 1.0 - s;
    return r * r * (1.0 + 2.0 * s) * p0_ + s * s * (3.0 - 2.0 * s) * p1_ + h_ * s * r * (r * v0_ - s * v1_);
  }
  Eigen::VectorXd velocity(double s) const {
    const double r = 1.0 - s;
    return 6.0 * s * r / h_ * (p1_ - p0_) + r * (1.0 - 3.0 * s) * v0_ + s * (3.0 * s - 2.0) * v1_;
  }
  Eigen::VectorXd acceleration(double s) const {
    return (6.0 - 12.0 * s) / (h_ * h_) * (p1_ - p0_) + ((6.0 * s - 4.0) * v0_ + (6.0 * s - 2.0) * v1_) / h_;
  }
  Eigen::VectorXd jerk() const {
    return -12.0 / (h_ * h_ * h_) * (p1_ - p0_) + 6.0 / (h_ * h_) * (v0_ + v1_);
  }
  /// Control points of the cubic (Bezier): it stays in their hull.
  Configuration first_handle() const { return p0_ + h_ / 3.0 * v0_; }
  Configuration second_handle() const { return p1_ - h_ / 3.0 * v1_; }

 private:
  double h_;
  const Configuration &p0_, &p1_;
  const Eigen::VectorXd &v0_, &v1_;
};

/// How far the cubics between two knots leave the chord.
Eigen::VectorXd tube_about(const Motion& motion, std::size_t begin, std::size_t end) {
  const Configuration &from = motion.positions[begin], &to = motion.positions[end];
  const Eigen::VectorXd step = to - from;
  const double length = step.squaredNorm();
  Eigen::VectorXd widest = Eigen::VectorXd::Zero(step.size());
  const auto widen = [&](const Configuration& q) {
    const double share = length > 0.0 ? std::clamp(step.dot(q - from) / length, 0.0, 1.0) : 0.0;
    widest = widest.cwiseMax((q - from - share * step).cwiseAbs());
  };
  for (std::size_t k = begin; k < end; ++k) {
    const Cubic cubic(motion, k);
    widen(motion.positions[k]);
    widen(cubic.first_handle());
    widen(cubic.second_handle());
  }
  return (widest.array() * (1.0 + 1e-9)).matrix();
}

/// In how many periods so many loads are taken or left.
std::size_t grip_knots(const Motion& motion, std::size_t count, double grip_time) {
  return count * static_cast<std::size_t>(std::ceil(grip_time / motion.period - 1e-9));
}

class MotionChecker {
 public:
  MotionChecker(const Robot& robot, const Motion& motion, const RateLimits& limits)
      : robot_(robot), motion_(motion), limits_(limits) {}

  MotionVerdict& verdict() { return verdict_; }
  bool is_refused() const { return !verdict_.fault.empty(); }

  void require_form() {
    const std::size_t n = motion_.positions.size();
    if (!(std::isfinite(motion_.period) && motion_.period > 0.0)) return refuse("its period is no time");
    if (n == 0 || motion_.velocities.size() != n || motion_.accelerations.size() != n)
      return refuse("it has not as many positions, velocities and accelerations");
    for (std::size_t k = 0; k < n; ++k)
      for (const auto* values : {&motion_.positions[k], &motion_.velocities[k], &motion_.accelerations[k]})
        if (values->size() != static_cast<Eigen::Index>(robot_.dof()) || !values->allFinite())
          return refuse("knot " + std::to_string(k) + " is not of " + std::to_string(robot_.dof()) +
                        " finite values");
    if (!(motion_.duration() <= longest))
      refuse("it lasts more than " + std::to_string(static_cast<int>(longest)) + " s");
  }

  void require_rests(const std::vector<std::size_t>& rests, const std::vector<Configuration>& stops,
                     const std::vector<std::size_t>& grips, double grip_time) {
    if (stops.size() != rests.size() + 1 || rests.empty())
      return refuse("it has " + counted(rests.size(), "leg") + ", the path " +
                    std::to_string(stops.empty() ? 0 : stops.size() - 1));
    if (!(std::isfinite(grip_time) && grip_time >= 0.0 && grip_time <= longest))
      return refuse("the time in which a load is taken or left is none");
    std::size_t knot = 0;
    require_rest(0, stops.front());
    for (std::size_t i = 0; i < rests.size() && !is_refused(); ++i) {
      if (rests[i] < knot || rests[i] >= motion_.positions.size())
        return refuse("its legs do not end one after the other");
      knot = rests[i];
      require_rest(knot, stops[i + 1]);
      if (i < grips.size() && grips[i] > 0) knot = require_grip(knot, grips[i], grip_time, i);
    }
    if (!is_refused() && knot + 1 != motion_.positions.size()) refuse("it goes on after its last leg");
  }

  void require_limits() {
    for (std::size_t k = 0; k + 1 < motion_.positions.size() && !is_refused(); ++k) {
      const Cubic cubic(motion_, k);
      require_same(k, cubic.acceleration(0.0), motion_.accelerations[k]);
      require_same(k + 1, cubic.acceleration(1.0), motion_.accelerations[k + 1]);
      require_reach(k, cubic);
      const int pieces = std::max(1, static_cast<int>(std::ceil(motion_.period / sample_period - 1e-9)));
      for (int i = 0; i <= pieces && !is_refused(); ++i) {
        const double s = static_cast<double>(i) / pieces;
        raise(k, cubic.velocity(s), cubic.acceleration(s), cubic.jerk());
        require_inside(k, cubic.position(s));
      }
    }
  }

  void refuse(const std::string& fault) {
    if (verdict_.fault.empty()) verdict_.fault = "motion: " + fault;
  }

 private:
  /// Stands where it stopped while loads are taken or left. Returns the knot at which it may go on.
  std::size_t require_grip(std::size_t knot, std::size_t count, double grip_time, std::size_t leg) {
    const std::size_t end = knot + grip_knots(motion_, count, grip_time);
    for (std::size_t k = knot; k <= end && !is_refused(); ++k)
      if (k >= motion_.positions.size() || !stands(k, motion_.positions[knot])) {
        std::ostringstream text;
        text.imbue(std::locale::classic());
        text << "after leg " << leg + 1 << " it does not rest for " << grip_time << " s for each of " << count
             << (count == 1 ? " load that begins" : " loads that begin") << " or ends to ride there";
        refuse(text.str());
      }
    return end;
  }

  bool stands(std::size_t knot, const Configuration& place) const {
    return (motion_.positions[knot] - place).cwiseAbs().maxCoeff() <= rounded_away && is_at_rest(knot);
  }

  bool is_at_rest(std::size_t knot) const {
    for (Eigen::Index j = 0; j < limits_.velocity.size(); ++j)
      if (!(std::abs(motion_.velocities[knot][j]) <= excess * limits_.velocity[j]) ||
          !(std::abs(motion_.accelerations[knot][j]) <= excess * limits_.acceleration[j]))
        return false;
    return true;
  }

  void refuse_joint(std::size_t k, Eigen::Index j, const char* what, double value, double other,
                    const char* other_is = ", its limit ") {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "after " << motion_.period * static_cast<double>(k) << " s the " << what << " of joint "
         << shortened(robot_.joints[static_cast<std::size_t>(j)].name) << " is " << text_beside(value, other)
         << other_is << other;
    refuse(text.str());
  }

  void require_rest(std::size_t knot, const Configuration& place) {
    const auto where = "at knot " + std::to_string(knot);
    if (place.size() != motion_.positions[knot].size() ||
        !((motion_.positions[knot] - place).cwiseAbs().maxCoeff() <= contract_tolerance))
      return refuse(where + " it is not where the path's leg begins or ends");
    if (!is_at_rest(knot)) refuse(where + " it does not rest");
  }

  void raise(std::size_t k, const Eigen::VectorXd& velocity, const Eigen::VectorXd& acceleration,
             const Eigen::VectorXd& jerk) {
    ++verdict_.samples;
    const auto compare = [&](const char* what, const Eigen::VectorXd& values, const Eigen::VectorXd& limits,
                             double& share) {
      for (Eigen::Index j = 0; j < values.size(); ++j) {
        const double used = std::abs(values[j]) / limits[j];
        if (!(used <= share)) share = used;
        if (!(used <= 1.0 + excess)) refuse_joint(k, j, what, values[j], limits[j]);
      }
    };
    compare("velocity", velocity, limits_.velocity, verdict_.shares.velocity);
    compare("acceleration", acceleration, limits_.acceleration, verdict_.shares.acceleration);
    compare("jerk", jerk, limits_.jerk, verdict_.shares.jerk);
  }

  void require_inside(std::size_t k, const Configuration& q) {
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Joint& joint = robot_.joints[static_cast<std::size_t>(j)];
      if (!(q[j] >= joint.lower - rounded_away))
        refuse_joint(k, j, "position", q[j], joint.lower);
      else if (!(q[j] <= joint.upper + rounded_away))
        refuse_joint(k, j, "position", q[j], joint.upper);
    }
  }

  /// Its control points are within the joint limits, and so is the cubic.
  void require_reach(std::size_t k, const Cubic& cubic) {
    require_inside(k, cubic.first_handle());
    require_inside(k, cubic.second_handle());
  }

  /// What the file says of the acceleration at a knot.
  void require_same(std::size_t k, const Eigen::VectorXd& found, const Eigen::VectorXd& said) {
    for (Eigen::Index j = 0; j < found.size(); ++j) {
      const double tolerance = excess * std::max(1.0, limits_.acceleration[j]);
      if (!(std::abs(found[j] - said[j]) <= tolerance))
        return refuse_joint(k, j, "acceleration that positions and velocities give", found[j], said[j],
                            ", but the motion says ");
    }
  }

  const Robot& robot_;
  const Motion& motion_;
  const RateLimits& limits_;
  MotionVerdict verdict_;
};

void require_limits_above_zero(const Robot& robot, const RateLimits& limits) {
  for (const auto* values : {&limits.velocity, &limits.acceleration, &limits.jerk})
    if (values->size() != static_cast<Eigen::Index>(robot.dof()) || !values->allFinite() ||
        !(values->minCoeff() > 0.0))
      throw std::invalid_argument("limits of a motion must be finite numbers above 0, one for each joint");
}

}  // namespace

MotionVerdict check_rates(const Robot& robot, const MotionToCheck& motion,
                          const std::vector<std::size_t>& grips) {
  require_limits_above_zero(robot, motion.limits);
  MotionChecker checker(robot, motion.motion, motion.limits);
  checker.require_form();
  if (!checker.is_refused()) checker.require_rests(motion.rests, motion.stops, grips, motion.grip_time);
  if (!checker.is_refused()) checker.require_limits();
  checker.verdict().valid = !checker.is_refused();
  return checker.verdict();
}

std::vector<std::size_t> grips_between(const std::vector<LegLoad>& loads, std::size_t legs) {
  std::vector<std::size_t> grips(legs == 0 ? 0 : legs - 1, 0);
  for (std::size_t leg = 0; leg < grips.size(); ++leg)
    for (const LegLoad& load : loads)
      grips[leg] += load.rides_on(static_cast<int>(leg)) != load.rides_on(static_cast<int>(leg) + 1);
  return grips;
}

std::vector<KnotRange> knots_of_legs(const MotionToCheck& motion, const std::vector<std::size_t>& grips) {
  std::vector<KnotRange> knots;
  for (std::size_t leg = 0; leg < motion.rests.size(); ++leg) {
    const std::size_t rest = leg < grips.size() ? grip_knots(motion.motion, grips[leg], motion.grip_time) : 0;
    knots.push_back({leg == 0 ? 0 : motion.rests[leg - 1], motion.rests[leg] + rest});
  }
  return knots;
}

MotionTubes tubes_of(const Motion& motion, KnotRange knots, std::size_t most) {
  MotionTubes tubes{{motion.positions[knots.first]}, {}};
  for (std::size_t begin = knots.first; begin < knots.last;) {
    std::size_t end = begin + 1;
    Eigen::VectorXd tube = tube_about(motion, begin, end);
    for (std::size_t length = 2; length <= most && begin + length <= knots.last; length *= 2) {
      const Eigen::VectorXd wider = tube_about(motion, begin, begin + length);
      if (wider.maxCoeff() > widest_tube) break;
      end = begin + length;
      tube = wider;
    }
    tubes.chords.push_back(motion.positions[end]);
    tubes.deviations.push_back(tube);
    begin = end;
  }
  if (tubes.deviations.empty())
    tubes.deviations.push_back(Eigen::VectorXd::Zero(tubes.chords.front().size()));
  return tubes;
}

void prove_tubes(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 double padding, double seen_within, const Motion& motion, KnotRange knots,
                 MotionVerdict& verdict) {
  for (const std::size_t most : {std::size_t{4096}, std::size_t{1}}) {
    const MotionTubes tubes = tubes_of(motion, knots, most);
    const PathVerdict path =
        check_tubes(robot, map, policies, padding, tubes.chords, tubes.deviations, 0.0, seen_within);
    verdict.undecided = path.undecided;
    if (path.valid) {
      const bool is_first = verdict.edges == 0;
      verdict.edges += tubes.deviations.size();
      verdict.min_clearance =
          is_first ? path.min_clearance : std::min(verdict.min_clearance, path.min_clearance);
      return;
    }
    if (most > 1) continue;
    verdict.valid = false;
    verdict.min_clearance = 0.0;
    verdict.edges += tubes.deviations.size();
    verdict.fault = "motion: " + path.first_contact;
  }
}

MotionVerdict check_motion(const Robot& robot, const Snapshot& map,
                           const std::map<std::string, Policy>& policies, double padding,
                           const Motion& motion, const std::vector<std::size_t>& rests,
                           const std::vector<Configuration>& stops, const RateLimits& limits,
                           double seen_within) {
  return check_motion(robot, map, policies, padding, {motion, rests, stops, limits}, std::vector<LegLoad>{},
                      seen_within);
}

MotionVerdict check_motion(const Robot& robot, const Snapshot& map,
                           const std::map<std::string, Policy>& policies, double padding,
                           const MotionToCheck& motion, const std::vector<LegLoad>& loads,
                           double seen_within) {
  const std::vector<std::size_t> grips = grips_between(loads, motion.rests.size());
  MotionVerdict verdict = check_rates(robot, motion, grips);
  if (!verdict.valid) return verdict;
  const std::vector<KnotRange> knots = knots_of_legs(motion, grips);
  for (std::size_t leg = 0; leg < knots.size() && verdict.valid;) {
    std::size_t last = leg;  // that the same loads ride on
    while (last < grips.size() && grips[last] == 0) ++last;
    prove_tubes(robot_of_leg(robot, loads, static_cast<int>(leg)), map, policies, padding, seen_within,
                motion.motion, {knots[leg].first, knots[last].last}, verdict);
    leg = last + 1;
  }
  return verdict;
}

}  // namespace clearway
