#include "planning/boundary/certified_motion.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "mapping/system/plain_text.hpp"

namespace clearway {

CertifiedMotion::CertifiedMotion(const PlanProblem& problem, const DamperOptions& options)
    : problem_(problem),
      options_(options),
      trace_{problem.start},
      least_separation_(options.influence_distance) {}

double CertifiedMotion::distance_to_goal() const {
  return options_.weight.cwiseProduct(problem_.goal - position()).norm();
}

Configuration CertifiedMotion::moved(const Eigen::VectorXd& step) const {
  Configuration q = position() + step.cwiseQuotient(options_.weight);
  const Robot& robot = problem_.space.robot();
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    q[j] = std::clamp(q[j], joint.lower, joint.upper);  // rounding at a limit
  }
  const double missed = options_.weight.cwiseProduct(problem_.goal - q).norm();
  return missed <= 1e-9 * options_.max_step ? problem_.goal : q;
}

bool CertifiedMotion::take(const Eigen::VectorXd& step, WaypointOrigin origin) {
  double share = 1.0;
  for (int halving = 0; halving <= 10; ++halving, share *= 0.5) {
    const Configuration next = moved(share * step);
    if (next == position()) return false;
    ++edges_checked_;
    if (!problem_.space.is_edge_free(position(), next)) continue;
    trace_.push_back(next);
    origin.search_step = steps();
    origins_.push_back(std::move(origin));
    if (halving > 0) ++shortened_;
    return true;
  }
  return false;
}

void CertifiedMotion::note(const StepConstraints& constraints, const LocalStep& step) {
  most_constraints_ = std::max(most_constraints_, constraints.pairs.size());
  least_separation_ = std::min(least_separation_, constraints.separation);
  if (step.demand < 1.0) ++relaxed_;
}

PlanResult CertifiedMotion::result(PlanResult result, PlanStatus status,
                                   const std::string& explanation) const {
  result.status = is_at_goal() ? PlanStatus::solved : status;
  result.explanation = explanation;
  result.final_distance = (problem_.goal - position()).norm();
  result.search_steps = steps();
  result.configurations_checked += trace_.size();
  result.edges_checked += edges_checked_;
  (is_at_goal() ? result.waypoints : result.explored) = trace_;
  result.origins = origins_;
  if (is_at_goal()) result.cost = problem_.cost(trace_);
  result.statistics["most_rows"] = static_cast<double>(most_constraints_);
  result.statistics["steps_shortened"] = shortened_;
  result.statistics["steps_relaxed"] = relaxed_;
  result.statistics["least_separation_m"] = least_separation_;
  result.statistics["max_step"] = options_.max_step;
  result.statistics["influence_distance_m"] = options_.influence_distance;
  result.statistics["security_distance_m"] = options_.security_distance;
  result.statistics["xi_m"] = options_.xi;
  return result;
}

bool CreepWatch::is_creeping(double distance_to_goal) {
  last_.push_back(distance_to_goal);
  if (last_.size() <= 10) return false;
  const double before = last_.front();
  last_.pop_front();
  return before - distance_to_goal < least_gain_;
}

std::string followed_name(const ConfigurationSpace& space, const StepConstraints& constraints, int source) {
  const Robot& robot = space.robot();
  const auto pairs = static_cast<int>(constraints.pairs.size()), n = static_cast<int>(robot.dof());
  if (source < 0 || source >= pairs + 2 * n) return {};
  if (source < pairs) {
    const int body = constraints.pairs[static_cast<std::size_t>(source)].body;
    return shortened(robot.bodies[static_cast<std::size_t>(body)].part) + " near what blocks it";
  }
  const int joint = (source - pairs) % n;
  return "joint " + shortened(robot.joints[static_cast<std::size_t>(joint)].name) + " near its " +
         (source - pairs < n ? "upper" : "lower") + " limit";
}

std::string holding_back(const ConfigurationSpace& space, const StepConstraints& constraints,
                         const Eigen::VectorXd& multipliers) {
  Eigen::Index strongest = 0;
  if (multipliers.size() == 0 || multipliers.maxCoeff(&strongest) <= 0.0)
    return "no constraint holds it back";
  const Robot& robot = space.robot();
  const auto pairs = static_cast<Eigen::Index>(constraints.pairs.size());
  if (strongest >= pairs) {
    const auto n = static_cast<Eigen::Index>(robot.dof());
    return "joint " + shortened(robot.joints[static_cast<std::size_t>((strongest - pairs) % n)].name) +
           " is at its limit";
  }
  const ProximityConstraint& pair = constraints.pairs[static_cast<std::size_t>(strongest)];
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.setf(std::ios::fixed);
  text.precision(1);
  text << shortened(robot.bodies[static_cast<std::size_t>(pair.body)].part) << " is "
       << 1000.0 * pair.distance << " mm from what blocks it near (";
  text.precision(3);
  text << pair.point[0] << ", " << pair.point[1] << ", " << pair.point[2] << ")";
  return text.str();
}

}  // namespace clearway
