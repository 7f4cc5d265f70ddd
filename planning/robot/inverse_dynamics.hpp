#pragma once

#include <vector>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// What hangs on a robot and pulls it.
struct JointLoad {
  double payload = 0.0;                      ///< kg at the tip, at this scale, a point
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, map frame
};

/// What torques are reckoned from beside the masses that a Robot holds.
struct TorqueTerms {
  std::vector<Eigen::Matrix3d> inertia;  ///< of each link about its centre of mass, link frame, kg m^2
  Eigen::VectorXd limits;                ///< of each joint, N m or N; infinity where none is known
  JointLoad load{};
};

/// The torque (N m) or force (N) of each joint that makes the robot move so: recursive Newton-Euler (Luh,
/// Walker and Paul, "On-line computational scheme for mechanical manipulators", 1980), in the map frame.
/// Links that the robot's file gives no mass weigh nothing; friction and the inertia of motors are not in it.
/// @param q, velocity, acceleration of robot.dof() joints, rad or m, by second, by second squared
Eigen::VectorXd joint_torques(const Robot& robot, const Configuration& q, const Eigen::VectorXd& velocity,
                              const Eigen::VectorXd& acceleration, const TorqueTerms& terms);

/// Whether something that the joint moves has mass, of each joint.
std::vector<bool> moves_mass(const Robot& robot, const JointLoad& load = {});

/// The links with bodies that move and to which the robot's file gives no mass. One that a single joint turns
/// about an upright axis is none of them: gravity does not pull it about (the first link of a PUMA).
/// @param gravity m/s^2, map frame
std::vector<std::string> links_without_mass(const Robot& robot,
                                            const Eigen::Vector3d& gravity = JointLoad().gravity);

/// The same as the beginning of a sentence: "The robot's file gives link 'x' and 2 others that move no mass
/// (<inertial>)"; empty where none lacks it.
std::string missing_masses(const Robot& robot, const Eigen::Vector3d& gravity);

}  // namespace clearway
