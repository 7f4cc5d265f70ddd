#include "planning/beam/beam_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDefaultTurn = 0.5 * kDegree;  ///< the paper's epsilon for all joints
constexpr double kDefaultSlide = 0.005;         ///< metres, full size

double given_step(const std::vector<double>& steps, std::size_t joint, const char* name, std::size_t dof) {
  if (steps.size() != 1 && steps.size() != dof) {
    throw std::invalid_argument("beam: option '" + std::string(name) + "' has " +
                                counted(steps.size(), "value") + ": expected one, or one for each of the " +
                                counted(dof, "joint"));
  }
  return steps.size() == 1 ? steps[0] : steps[joint];
}

double step_of(const Robot& robot, std::size_t j, const BeamOptions& options) {
  const Joint& joint = robot.joints[j];
  const bool turns = joint.kind == JointKind::revolute;
  if (turns && !options.step_deg.empty())
    return kDegree * given_step(options.step_deg, j, "step_deg", robot.dof());
  if (!options.step.empty()) return given_step(options.step, j, "step", robot.dof());
  if (joint.step > 0.0) return joint.step;
  return turns ? kDefaultTurn : kDefaultSlide * robot.scale;
}

}  // namespace

Lattice::Lattice(const PlanProblem& problem, const BeamOptions& options)
    : start_(problem.start),
      goal_(problem.goal),
      weight_(joint_weights(problem.space, options.prismatic_scale)) {
  const Robot& robot = problem.space.robot();
  const auto n = static_cast<Eigen::Index>(robot.dof());
  step_.resize(n), lower_.resize(n), upper_.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto joint = static_cast<std::size_t>(j);
    step_[j] = step_of(robot, joint, options);
    lower_[j] = robot.joints[joint].lower;
    upper_[j] = robot.joints[joint].upper;
  }
}

Configuration Lattice::configuration(const LatticeIndex& node) const {
  Configuration q(dof());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = value(j, node[static_cast<std::size_t>(j)]);
  return q;
}

bool Lattice::keeps_limits(const LatticeIndex& node) const {
  for (Eigen::Index j = 0; j < dof(); ++j) {
    const double q = value(j, node[static_cast<std::size_t>(j)]);
    if (!(q >= lower_[j] && q <= upper_[j])) return false;
  }
  return true;
}

double Lattice::distance_term(Eigen::Index joint, int index) const {
  const double difference = weight_[joint] * (value(joint, index) - goal_[joint]);
  return difference * difference;
}

double Lattice::squared_distance(const LatticeIndex& node) const {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < dof(); ++j) sum += distance_term(j, node[static_cast<std::size_t>(j)]);
  return sum;
}

bool Lattice::reaches_goal(const LatticeIndex& node) const {
  const Configuration q = configuration(node);
  return ((q - goal_).array().abs() <= (1.0 + 1e-9) * step_.array()).all();
}

double Lattice::longest_ramp() const {
  return dof() == 0 ? 0.0 : ((goal_ - start_).array().abs() / step_.array()).maxCoeff();
}

}  // namespace clearway
