#include "planning/check/motion_check.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

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

  void require_rests(const std::vector<std::size_t>& rests, const std::vector<Configuration>& stops) {
    if (stops.size() != rests.size() + 1 || rests.empty())
      return refuse("it has " + std::to_string(rests.size()) + " legs, the path " +
                    std::to_string(stops.empty() ? 0 : stops.size() - 1));
    std::size_t knot = 0;
    require_rest(0, stops.front());
    for (std::size_t i = 0; i < rests.size() && !is_refused(); ++i) {
      if (rests[i] < knot || rests[i] >= motion_.positions.size())
        return refuse("its legs do not end one after the other");
      knot = rests[i];
      require_rest(knot, stops[i + 1]);
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

  /// Chords, and how far the cubics leave them. At least one chord for each `most` knots.
  void cut(std::size_t most, std::vector<Configuration>& chords, std::vector<Eigen::VectorXd>& tubes) const {
    const std::size_t last = motion_.positions.size() - 1;
    chords = {motion_.positions.front()};
    tubes.clear();
    for (std::size_t begin = 0; begin < last;) {
      std::size_t end = begin + 1;
      Eigen::VectorXd tube = tube_about(begin, end);
      for (std::size_t length = 2; length <= most && begin + length <= last; length *= 2) {
        const Eigen::VectorXd wider = tube_about(begin, begin + length);
        if (wider.maxCoeff() > widest_tube) break;
        end = begin + length;
        tube = wider;
      }
      chords.push_back(motion_.positions[end]);
      tubes.push_back(tube);
      begin = end;
    }
    if (tubes.empty()) tubes.push_back(Eigen::VectorXd::Zero(chords.front().size()));
  }

  void refuse(const std::string& fault) {
    if (verdict_.fault.empty()) verdict_.fault = "motion: " + fault;
  }

 private:
  void refuse_joint(std::size_t k, Eigen::Index j, const char* what, double value, double limit) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "after " << motion_.period * static_cast<double>(k) << " s the " << what << " of joint "
         << robot_.joints[static_cast<std::size_t>(j)].name << " is " << value << ", its limit " << limit;
    refuse(text.str());
  }

  void require_rest(std::size_t knot, const Configuration& place) {
    const auto where = "at knot " + std::to_string(knot);
    if (place.size() != motion_.positions[knot].size() ||
        !((motion_.positions[knot] - place).cwiseAbs().maxCoeff() <= contract_tolerance))
      return refuse(where + " it is not where the path's leg begins or ends");
    for (Eigen::Index j = 0; j < place.size(); ++j)
      if (!(std::abs(motion_.velocities[knot][j]) <= excess * limits_.velocity[j]) ||
          !(std::abs(motion_.accelerations[knot][j]) <= excess * limits_.acceleration[j]))
        return refuse(where + " it does not rest");
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
        return refuse_joint(k, j, "acceleration between the knots", found[j], said[j]);
    }
  }

  Eigen::VectorXd tube_about(std::size_t begin, std::size_t end) const {
    const Configuration &from = motion_.positions[begin], &to = motion_.positions[end];
    const Eigen::VectorXd step = to - from;
    const double length = step.squaredNorm();
    Eigen::VectorXd widest = Eigen::VectorXd::Zero(step.size());
    const auto widen = [&](const Configuration& q) {
      const double share = length > 0.0 ? std::clamp(step.dot(q - from) / length, 0.0, 1.0) : 0.0;
      widest = widest.cwiseMax((q - from - share * step).cwiseAbs());
    };
    for (std::size_t k = begin; k < end; ++k) {
      const Cubic cubic(motion_, k);
      widen(motion_.positions[k]);
      widen(cubic.first_handle());
      widen(cubic.second_handle());
    }
    return (widest.array() * (1.0 + 1e-9)).matrix();
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

MotionVerdict check_motion(const Robot& robot, const Snapshot& map,
                           const std::map<std::string, Policy>& policies, double padding,
                           const Motion& motion, const std::vector<std::size_t>& rests,
                           const std::vector<Configuration>& stops, const RateLimits& limits,
                           double seen_within) {
  require_limits_above_zero(robot, limits);
  MotionChecker checker(robot, motion, limits);
  MotionVerdict& verdict = checker.verdict();
  checker.require_form();
  if (!checker.is_refused()) checker.require_rests(rests, stops);
  if (!checker.is_refused()) checker.require_limits();
  // Tubes about few long chords first; where these are too wide, one about each cubic.
  for (const std::size_t most : {std::size_t{4096}, std::size_t{1}}) {
    if (checker.is_refused()) break;
    std::vector<Configuration> chords;
    std::vector<Eigen::VectorXd> tubes;
    checker.cut(most, chords, tubes);
    const PathVerdict path = check_tubes(robot, map, policies, padding, chords, tubes, 0.0, seen_within);
    verdict.edges = tubes.size();
    verdict.valid = path.valid;
    verdict.undecided = path.undecided;
    verdict.min_clearance = path.min_clearance;
    if (path.valid) break;
    if (most == 1) checker.refuse(path.first_contact);
  }
  return verdict;
}

}  // namespace clearway
