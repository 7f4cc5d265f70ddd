#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "planning/geometry/shape.hpp"

namespace clearway {

struct Robot;

/// An object that rides on a link of a robot (Chong et al. 2008, section 4): one more body, which nothing
/// moves against its link.
struct Load {
  std::string name;  ///< of letters, digits, '_', '-' and '.'; the part that policies and messages name
  std::string link;  ///< that carries it
  Eigen::Isometry3d link_from_load = Eigen::Isometry3d::Identity();  ///< metres of the map, as the robot's
  Shape shape = Shape::sphere(1.0);  ///< metres of the map, whatever the robot's scale
  double mass = 0.0;                 ///< kg at full size, its centre at the shape's origin
  std::vector<std::string> touches;  ///< links beside the one that carries it which may touch it: fingers
};

/// A load, and on which legs of a query it rides.
struct LegLoad {
  Load load;
  std::vector<int> legs;  ///< from 0; none: all of them

  bool rides_on(int leg) const;
};

/// The robot with the load: a fixed link and a body of its name behind all others, which may touch what
/// carries it and the links that `touches` names, and nothing else. What it must lie in is what its carrier
/// and these must lie in (part_policies).
/// @throws std::invalid_argument in one sentence: a name that is taken or holds other characters, a link that
///         the robot does not have (naming the nearest one), a pose or mass that is none.
Robot with_load(const Robot& robot, const Load& load);

/// What its user should look at: a load of more than 20 m is one in millimetres; else empty.
std::string size_note(const Load& load);

/// The robot as it is on a leg: with the loads that ride on it. @throws as with_load
Robot robot_of_leg(const Robot& robot, const std::vector<LegLoad>& loads, int leg);

/// Indices of the joints that hold the load, as fingers do: they move links that `touches` names against its
/// own, and nothing that does not ride along with that; not one finger alone that the tip is on: that is a
/// wrist. They stand still while it rides. None if no joint moves its link. @param robot with or without it
std::vector<int> grip_joints(const Robot& robot, const Load& load);

/// The robot whose joints that hold its loads can only be where `q` has them, if that is within their limits.
Robot with_still_grip(const Robot& robot, const Eigen::VectorXd& q);

/// Empty, or the sentence that a joint which holds a load would have to move by more than 1e-6 rad or m.
std::string grip_violation(const Robot& robot, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// The parts that hold a load, carrier first: the nearest link from its own towards the root that has a
/// body, then those that it touches. @pre `part` is one of the robot's loads; empty for any other part
std::vector<std::string> holders_of(const Robot& robot, const std::string& part);

/// The same in shape and place, touching the same, within 1e-6 m and kg.
bool is_same(const Load& a, const Load& b);

}  // namespace clearway
