#pragma once

#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot with every body that a joint does nothing to but turn it about its own axis of symmetry carried
/// by the link before that joint, for which the joint is axisymmetric: a gripper's bounding cylinder on the
/// last wrist joint, a capsule around the forearm's roll. Bodies take up the same space in every
/// configuration as before, and what was computed of them for one value of that joint holds for all. Only
/// bodies that some other joint still moves are carried so; axis and body must agree to rounding (1e-15 of
/// their sizes).
Robot without_axisymmetric_joints(Robot robot);

}  // namespace clearway
