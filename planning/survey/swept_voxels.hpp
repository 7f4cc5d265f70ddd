#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Voxels of the map's grid that bodies touch, by what the map knows of them.
///
/// They are those that a body touches at poses along the path between which no point of it moves farther than
/// one voxel's edge (the bodies as they are, without padding). No voxel is counted that no body touches; one
/// that is left out is entered by at most half its edge.
struct SweptVoxels {
  double edge = 0.0;  ///< of a voxel, metres
  std::size_t painted = 0;
  std::size_t seen_free = 0;
  std::size_t seen_once = 0;  ///< of these: the evidence is no more than that of one look through the voxel
  /// Of seen_free, in a map of which voxels were made free by hand: those of these that no sensor saw again,
  /// and those of which no look is known.
  std::size_t maybe_by_hand = 0;
  std::size_t occupied =
      0;  ///< occupied and conflicts: of bodies that no joint moves, or of a path that collides
  std::size_t unknown = 0;
  std::size_t beyond = 0;  ///< of these: outside the box around all voxels that the map stores
  /// Seconds from the last look at a seen-free voxel to the newest look of the map, where that is longest.
  /// None where there is no such voxel, or the map does not know it for all of them.
  std::optional<double> oldest_look = {};

  std::size_t total() const { return painted + seen_free + occupied + unknown; }
  double litres(std::size_t voxels) const;
  /// Of the total, 0 to 1.
  double share(std::size_t voxels) const;

  friend bool operator==(const SweptVoxels&, const SweptVoxels&) = default;
};

/// What the bodies that some joint moves sweep along the path, all of its edges straight in joint space. None
/// for an empty path, for bodies of more than some 10^8 voxels, and where counting would take longer than
/// some 10 seconds. Precondition: every waypoint has as many values as the robot has joints, all finite.
std::optional<SweptVoxels> swept_voxels(const Robot& robot, const Snapshot& map,
                                        const std::vector<Configuration>& path);

/// A body that no joint moves and that touches occupied voxels (conflicts included). Such bodies are part of
/// the scene: no path is refused for them.
struct StandingContact {
  std::string part;
  std::size_t voxels = 0;
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero();  ///< centre of one: the first in z, y, x

  friend bool operator==(const StandingContact&, const StandingContact&) = default;
};

/// One for each body that no joint moves and that touches occupied voxels, in the robot's order.
std::vector<StandingContact> standing_contacts(const Robot& robot, const Snapshot& map);

}  // namespace clearway
