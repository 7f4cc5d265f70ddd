#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Bounds on where bodies can be and how far joints can throw them, over all configurations within the
/// limits. Upper bounds: a little too large, never too small.

/// A box in the map frame that holds the body in every configuration. The z extent of planar arms and of
/// sliding robots stays exact: rotations about one common axis are followed as such.
Eigen::AlignedBox3d reach_box(const Robot& robot, const Body& body);

/// Largest distance of any point of the body from the axis of the (revolute) joint that moves `link`, which
/// must lie on the body's chain; metres per radian of that joint. For a prismatic joint 1.
double lever(const Robot& robot, int link, const Body& body);

/// Largest distance of any point of any body that hangs on the link from the link's origin.
double reach_below(const Robot& robot, int link);

/// For each joint how far it moves any point of the body at most, metres per unit: the levers of all links
/// that it moves, added up.
Eigen::VectorXd body_levers(const Robot& robot, const Body& body);

/// Largest distance of the tip from the base's origin.
double tip_reach(const Robot& robot);

/// True when some joint moves the link against the map.
bool is_moved(const Robot& robot, int link);

/// True when some joint moves the link, or one that is held still could: its bodies are looked at in the map.
/// What no joint ever moves, as a foot on its table, is not, nor what Robot::standing names, as a wheel.
bool is_policed(const Robot& robot, int link);

}  // namespace clearway
