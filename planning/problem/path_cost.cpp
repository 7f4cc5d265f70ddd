#include "planning/problem/path_cost.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace clearway {
namespace {

/// What hangs on a joint: all distal masses and the load.
struct Distal {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< sum of mass * position, base frame
};

/// pose * point, without a fourth coordinate.
Eigen::Vector3d placed(const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
  const auto column = [&](int i) { return pose.matrix().col(i).head<3>(); };
  return column(0) * point.x() + column(1) * point.y() + column(2) * point.z() + column(3);
}

/// Distal masses of every link (the link itself included). Links are stored parents first.
void distal_masses(const Robot& robot, const LinkPoses& poses, double payload, std::vector<Distal>& distal) {
  distal.assign(robot.links.size(), {});
  for (std::size_t i = robot.links.size(); i-- > 0;) {
    const Link& link = robot.links[i];
    distal[i].mass += link.mass;
    distal[i].moment += link.mass * placed(poses[i], link.center_of_mass);
    if (static_cast<int>(i) == robot.tip_link) {
      distal[i].mass += payload;
      distal[i].moment += payload * placed(poses[i], robot.link_from_tip.translation());
    }
    if (link.parent >= 0) {
      distal[static_cast<std::size_t>(link.parent)].mass += distal[i].mass;
      distal[static_cast<std::size_t>(link.parent)].moment += distal[i].moment;
    }
  }
}

/// Friction magnitude and signed gravity force of each joint, Chong 2008, eq. 8.
struct JointForces {
  Eigen::VectorXd friction;  ///< mu_j F_N r_j or mu_j F_N, >= 0
  Eigen::VectorXd gravity;   ///< what holds the arm still: -W.(z x rho) or -W.z; |gravity| = F_T r_j or F_T
};

/// Valid until this thread asks again: a search asks for the forces of thousands of configurations.
const JointForces& joint_forces(const Robot& robot, const CostOptions& options, const LinkPoses& poses) {
  thread_local std::vector<Distal> distal;
  thread_local JointForces forces;
  distal_masses(robot, poses, options.payload_mass, distal);
  const auto n = static_cast<Eigen::Index>(robot.dof());
  forces.friction.setZero(n);
  forces.gravity.setZero(n);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    if (link.joint < 0 || distal[i].mass <= 0.0) continue;
    const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
    const Eigen::Vector3d z = poses[i].linear() * axis_of(robot, link);
    const Eigen::Vector3d W = distal[i].mass * options.gravity;
    const double along = W.dot(z);
    if (kind_of(robot, link) == JointKind::revolute) {
      const Eigen::Vector3d from_origin = distal[i].moment / distal[i].mass - poses[i].translation();
      const Eigen::Vector3d rho = from_origin - from_origin.dot(z) * z;
      forces.friction[link.joint] +=
          std::abs(link.multiplier) * joint.friction * std::abs(along) * rho.norm();
      forces.gravity[link.joint] -= link.multiplier * W.dot(z.cross(rho));
    } else {
      forces.friction[link.joint] += std::abs(link.multiplier) * joint.friction * (W - along * z).norm();
      forces.gravity[link.joint] -= link.multiplier * along;
    }
  }
  return forces;
}

}  // namespace

PathCost::PathCost(const Robot& robot, const CostOptions& options)
    : robot_(scaled(robot, 1.0 / robot.scale)), options_(options), scale_(robot.scale) {
  if (!options.gravity.allFinite()) throw std::invalid_argument("path cost: gravity must be finite");
  if (!(options.payload_mass >= 0.0) || !std::isfinite(options.payload_mass)) {
    throw std::invalid_argument("path cost: payload mass is " + std::to_string(options.payload_mass) +
                                " kg: expected a finite number >= 0");
  }
  robot_.map_from_base = Eigen::Isometry3d::Identity();  // gravity is given in the base frame
}

Configuration PathCost::full_size(const Configuration& q) const {
  Configuration full = q;
  for (std::size_t j = 0; j < robot_.dof(); ++j) {
    if (robot_.joints[j].kind == JointKind::prismatic) full[static_cast<Eigen::Index>(j)] /= scale_;
  }
  return full;
}

Eigen::VectorXd PathCost::generalized_forces(const Configuration& q) const {
  thread_local LinkPoses poses;
  if (scale_ == 1.0)
    forward_kinematics(robot_, q, poses);
  else
    forward_kinematics(robot_, full_size(q), poses);
  return generalized_forces(poses);
}

Eigen::VectorXd PathCost::generalized_forces(const LinkPoses& poses) const {
  const JointForces& forces = joint_forces(robot_, options_, poses);
  return forces.friction + forces.gravity.cwiseAbs();
}

Eigen::VectorXd PathCost::gravity_torques(const Configuration& q) const {
  return joint_forces(robot_, options_, forward_kinematics(robot_, full_size(q))).gravity;
}

double PathCost::step_cost(const Eigen::VectorXd& forces_from, const Eigen::VectorXd& forces_to,
                           const Eigen::VectorXd& dq) const {
  if (scale_ == 1.0) return (0.5 * (forces_from + forces_to)).dot(dq.cwiseAbs());
  return (0.5 * (forces_from + forces_to)).dot(full_size(dq).cwiseAbs());
}

double PathCost::operator()(const std::vector<Configuration>& waypoints) const {
  double cost = 0.0;
  Eigen::VectorXd before;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    Eigen::VectorXd forces = generalized_forces(waypoints[i]);
    if (i > 0) cost += step_cost(before, forces, waypoints[i] - waypoints[i - 1]);
    before = std::move(forces);
  }
  return cost;
}

}  // namespace clearway
