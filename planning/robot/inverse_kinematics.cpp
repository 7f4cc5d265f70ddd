#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "mapping/system/random_unit.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/puma_branches.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Position error in the first three rows, rotation vector of the orientation error in the last three, map
/// frame.
Eigen::Matrix<double, 6, 1> pose_error(const Eigen::Isometry3d& wanted, const Eigen::Isometry3d& is) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(wanted.linear() * is.linear().transpose()));
  Eigen::Matrix<double, 6, 1> error;
  error << wanted.translation() - is.translation(), turn.angle() * turn.axis();
  return error;
}

/// Keeps of the error what leads into the tolerance, and of the rows of rotation or translation their part
/// that counts for it: none within it, beyond it that along the error.
void leave_free(double tolerance, Eigen::Ref<Eigen::Vector3d> error, Eigen::Matrix3d& rows) {
  const double size = error.norm();
  if (tolerance <= 0.0) return;
  if (size <= tolerance) {
    error.setZero();
    rows.setZero();
    return;
  }
  const Eigen::Vector3d along = error / size;
  error = (size - tolerance) * along;
  rows = along * along.transpose();
}

/// The shortest turn of the tip's axis onto the wanted one.
Eigen::Vector3d tilt_of_axis(const Eigen::Vector3d& is, const Eigen::Vector3d& wanted) {
  const Eigen::Vector3d across = is.cross(wanted);
  const double angle = std::atan2(across.norm(), is.dot(wanted));
  return angle * (across.norm() > 1e-12 ? across.normalized() : is.unitOrthogonal());
}

/// What of a pose's error counts: the rows of the error and of the Jacobian are turned by `rows`.
struct FreedRows {
  Eigen::Matrix3d translation = Eigen::Matrix3d::Identity(), rotation = Eigen::Matrix3d::Identity();
};

FreedRows leave_free(const IkOptions& options, const Eigen::Isometry3d& wanted, const Eigen::Isometry3d& is,
                     Eigen::Matrix<double, 6, 1>& error) {
  FreedRows rows;
  if (options.free_axis) {
    const Eigen::Vector3d axis = is.linear().col(*options.free_axis);
    error.tail<3>() = tilt_of_axis(axis, wanted.linear().col(*options.free_axis));
    rows.rotation -= axis * axis.transpose();
  }
  leave_free(options.free_distance, error.head<3>(), rows.translation);
  leave_free(options.free_turn, error.tail<3>(), rows.rotation);
  return rows;
}

void clamp_to_limits(const Robot& robot, Configuration& q) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    double& value = q[static_cast<Eigen::Index>(j)];
    value = std::clamp(value, robot.joints[j].lower, robot.joints[j].upper);
  }
}

/// What a step of each joint is damped by: the square of how far it moves the tip, so that a robot ten times
/// as large, and a joint that slides, take the same steps.
Eigen::VectorXd damping_of_joints(const Robot& robot, double size) {
  Eigen::VectorXd damping(robot.dof());
  for (std::size_t j = 0; j < robot.dof(); ++j)
    damping[static_cast<Eigen::Index>(j)] = robot.joints[j].kind == JointKind::prismatic ? 1.0 : size * size;
  return damping;
}

/// Where a configuration brings the tip, and what of the pose's error counts there.
struct Reached {
  LinkPoses poses;
  Eigen::Isometry3d tip;
  Eigen::Matrix<double, 6, 1> error;
  FreedRows freed;
};

void reach(const Robot& robot, const Eigen::Isometry3d& wanted, const IkOptions& options,
           const Configuration& q, Reached& reached) {
  forward_kinematics(robot, q, reached.poses);
  reached.tip = reached.poses[static_cast<std::size_t>(robot.tip_link)] * robot.link_from_tip;
  reached.error = pose_error(wanted, reached.tip);
  if (options.leaves_freedom()) reached.freed = leave_free(options, wanted, reached.tip, reached.error);
}

using Weights = Eigen::Matrix<double, 6, 1>;

/// The weighted error's normal equations.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd pull;
};

NormalEquations equations_at(const Robot& robot, const IkOptions& options, const Weights& weights,
                             const Reached& at) {
  const Eigen::Index rows = options.position_only ? 3 : 6;
  Eigen::MatrixXd j = weights.head(rows).asDiagonal() *
                      jacobian(robot, at.poses, robot.tip_link, at.tip.translation()).topRows(rows);
  if (options.leaves_freedom()) {
    j.topRows<3>() = (at.freed.translation * j.topRows<3>()).eval();
    if (!options.position_only) j.bottomRows<3>() = (at.freed.rotation * j.bottomRows<3>()).eval();
  }
  return {j.transpose() * j, j.transpose() * at.error.cwiseProduct(weights).head(rows)};
}

/// Levenberg-Marquardt on the pose error, orientation weighted by the robot's size, steps clamped into the
/// limits; a step that does not help is tried again with more damping.
bool descend(const Robot& robot, const Eigen::Isometry3d& wanted, const IkOptions& options, double size,
             Configuration& q) {
  const Eigen::Index rows = options.position_only ? 3 : 6;
  Weights weights;
  weights << 1.0, 1.0, 1.0, size, size, size;
  Reached here, there;
  reach(robot, wanted, options, q, here);
  const Eigen::VectorXd damped = damping_of_joints(robot, size);
  const auto cost = [&](const Reached& at) {
    return at.error.cwiseProduct(weights).head(rows).squaredNorm();
  };
  double damping = 1e-3, last = cost(here);
  NormalEquations equations;
  bool has_moved = true;  // since they were made
  for (int i = 0; i < options.max_iterations; ++i) {
    const bool is_near = here.error.head<3>().norm() <= options.position_tolerance;
    if (is_near && (options.position_only || here.error.tail<3>().norm() <= options.orientation_tolerance))
      return true;
    if (has_moved) equations = equations_at(robot, options, weights, here);
    Eigen::MatrixXd matrix = equations.matrix;
    matrix.diagonal() += damping * damped;
    Configuration next = q + matrix.ldlt().solve(equations.pull);
    clamp_to_limits(robot, next);
    reach(robot, wanted, options, next, there);
    const double now = cost(there);
    has_moved = now < last;
    if (has_moved) {
      q = next;
      std::swap(here, there);
      last = now;
      damping = std::max(damping / 5.0, 1e-12);
    } else {
      damping *= 4.0;
      if (damping > 1e6) break;
    }
  }
  return false;
}

/// A length typical of the arm: what a rotation is worth against a translation.
double arm_size(const Robot& robot) {
  double size = robot.link_from_tip.translation().norm();
  for (int i = robot.tip_link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    size += robot.links[static_cast<std::size_t>(i)].parent_from_link.translation().norm();
  }
  return size > 0.0 ? size / 2 : 1.0;
}

/// `near` first, then seeded random starts within the limits; nothing where all links in a row are too short.
std::optional<Configuration> numeric_inverse_kinematics(const Robot& robot, const Eigen::Isometry3d& wanted,
                                                        const Configuration& near, const IkOptions& options) {
  const double away = (wanted.translation() - robot.map_from_base.translation()).norm();
  if (away > tip_reach(robot) + options.position_tolerance + options.free_distance) return std::nullopt;
  const double size = arm_size(robot);
  std::mt19937_64 random(options.seed);
  for (int start = 0; start <= options.restarts; ++start) {
    Configuration q = near;
    for (std::size_t j = 0; start > 0 && j < robot.dof(); ++j) {
      const Joint& joint = robot.joints[j];
      const double here = near[static_cast<Eigen::Index>(j)];
      const double lower = std::isfinite(joint.lower) ? joint.lower : here - std::numbers::pi;
      const double upper = std::isfinite(joint.upper) ? joint.upper : here + std::numbers::pi;
      const double value = lower + (upper - lower) * random_unit(random);
      if (moves_tip(robot, j)) q[static_cast<Eigen::Index>(j)] = value;  // fingers stay
    }
    clamp_to_limits(robot, q);
    if (descend(robot, wanted, options, size, q)) return unwrapped_within_limits(robot, q, near).value_or(q);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Configuration> inverse_kinematics(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                                const Configuration& near, const IkOptions& options) {
  if (near.size() == static_cast<Eigen::Index>(robot.dof()) && !near.allFinite()) return std::nullopt;
  require_configuration(robot, near, "inverse kinematics: near");
  if (options.free_axis && (*options.free_axis < 0 || *options.free_axis > 2))
    throw std::invalid_argument("inverse kinematics: free_axis is " + std::to_string(*options.free_axis) +
                                ", expected 0, 1 or 2");
  if (!map_from_tip.matrix().allFinite()) return std::nullopt;
  if (robot.inverse_kinematics != "puma" || options.position_only || options.leaves_freedom()) {
    return numeric_inverse_kinematics(robot, map_from_tip, near, options);
  }
  const double fourth = near.size() > 3 ? near[3] : 0.0;  // of another arm: refused there
  const auto branches = puma_branches(robot, map_from_tip, fourth);
  const auto solution = branches[puma_branch_of(robot, near)];
  return solution ? unwrapped_within_limits(robot, *solution, near) : std::nullopt;
}

}  // namespace clearway
