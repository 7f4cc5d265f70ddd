#pragma once

#include <Eigen/Core>

#include "mapping/voxels/voxel_state.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// The body that a route is sought for: the critical part that has to stay in paint, else what the tip's link
/// carries (or the nearest link before it that carries anything).
struct EndEffector {
  int body = 0;  ///< in robot.bodies
  int link = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< link frame: middle of the body
  double inner_radius = 0.0;  ///< of a sphere about the middle that lies inside the body, metres
  double outer_radius = 0.0;  ///< of one that holds it
  Requirement requirement;    ///< what the body must lie in

  /// What blocks the hand; valid as long as `space`.
  const BlockedSpace& blocked(const ConfigurationSpace& space) const { return *space.blocked_space(body); }

  /// Middle of the body in the map frame at q.
  Eigen::Vector3d position(const Robot& robot, const Configuration& q) const;
};

/// @throws std::invalid_argument when no joint moves any body.
EndEffector find_end_effector(const ConfigurationSpace& space);

}  // namespace clearway
