#pragma once

#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Two bodies that must not touch, and per joint a bound on how fast their points approach, m/rad or 1.
struct BodyPair {
  int first = 0, second = 0;  ///< indices in Robot::bodies, first < second
  Eigen::VectorXd approach;   ///< sum over the links between them of their levers
};

/// All pairs of bodies that are not exempt and that some joint moves against each other, or one that is held
/// still could, in order.
std::vector<BodyPair> self_collision_pairs(const Robot& robot);

/// Bounds of the distance between the bodies of a pair; stops early once `lower > enough`.
DistanceBounds pair_distance(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link,
                             double enough = 1e9);

/// A lower bound of that distance: between spheres that hold the bodies when these are `enough` apart, else
/// the exact one.
double pair_distance_bound(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link,
                           double enough);

/// True when the bodies are proved to be farther apart than `margin`; cheap when they are far.
bool is_apart(const Robot& robot, const BodyPair& pair, const LinkPoses& map_from_link, double margin);

}  // namespace clearway
