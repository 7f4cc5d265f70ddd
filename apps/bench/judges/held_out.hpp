#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/simulation/room.hpp"
#include "mapping/scans/scan.hpp"

namespace clearway::bench {

/// A surface point of a scan that the map never sees, map frame.
struct HeldOutPoint {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> exact;  ///< where the ray truly met the surface, when that is known
  bool grazing = false;  ///< ray and surface normal enclose more than 70 degrees, or 60 (wide)
  std::optional<Eigen::Vector3d> before{};  ///< 5 cm before the surface along its normal, when that is known
};

/// A sequence of scans, every other one held out.
struct HeldOutSequence {
  std::string source;       ///< for the result: where it is from and how its normals are known
  std::vector<Scan> scans;  ///< to integrate
  std::vector<HeldOutPoint> held_out;
  double max_range = 0.0;  ///< metres, 0 = none; farther points are neither integrated nor judged
};

/// Every other frame of the generated room. Normals and exact points are the room's own.
/// @param exact_poses ignore the pose errors of the room.
HeldOutSequence hold_out(const FurnishedRoom& room, const std::vector<CloudFrame>& frames, bool exact_poses);

/// Every other frame that the room delivers, as it comes. Normals and points are the room's own.
HeldOutSequence hold_out_wide(const FurnishedRoom& room);

/// Every other cloud of a recording, at most `frames` of them spread evenly. The normal of a point is that of
/// the plane fitted (least squares) to its neighbours in the sensor's field of view, within 3 cm or 4 sigma
/// of the range noise; a point with fewer than 12 neighbours, or of a 2D laser, counts as not grazing.
/// @throws std::invalid_argument when the recording cannot be read or holds fewer than two clouds.
HeldOutSequence hold_out(const std::filesystem::path& recording, std::size_t frames);

}  // namespace clearway::bench
