#pragma once

#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// Inertias and limits of torque (`effort`) from the URDF that the robot was loaded from, at the robot's
/// scale: inertias grow with its fifth power, limits with the fourth as weights' torques do, of slides with
/// the third. Where the file gives no effort above 0, or nothing that the joint moves has mass, there is no
/// limit. A robot made in memory has no inertia and no limits.
/// @param load at the robot's scale
/// @throws std::invalid_argument when the file can no longer be read, naming file and field.
TorqueTerms torque_terms(const Robot& robot, const JointLoad& load = {});

}  // namespace clearway
