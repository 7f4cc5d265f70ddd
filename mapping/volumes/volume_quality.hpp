#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "mapping/volumes/sphere_union.hpp"

namespace clearway {

/// An enclosed pocket of a painted volume: voxels that a part with the policy `painted` may not enter (not
/// painted, or painted and occupied), connected over faces and cut off from the outside. Over an edge or a
/// corner nothing of any size passes, so a pocket that touches another one, or the outside, only there is a
/// pocket of its own.
struct VolumeHole {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< map frame; of a bent pocket it may lie outside it
  Eigen::Vector3d inside = Eigen::Vector3d::Zero();    ///< centre of one of its voxels
  std::size_t voxels = 0;
  double volume = 0.0;  ///< m^3
  std::size_t beyond_spheres =
      0;                     ///< of its voxels, those whose centre no sphere holds; 0: a finer map closes it
  std::size_t occupied = 0;  ///< of its voxels, those that are painted but sensed occupied
};

/// The narrowest place on the widest way between two parts of a painted volume.
struct VolumeNeck {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame; a voxel centre
  double radius = 0.0;   ///< largest sphere about `position` inside the voxels, metres; a sphere smaller by
                         ///< half a voxel passes from part to part
  double smaller = 0.0;  ///< radius of the largest sphere in the lesser of the two parts, metres
  double larger = 0.0;   ///< the same of the other part; both are cut off at 1.5 times the largest sphere
};

/// Two successive spheres that are apart, or meet in a circle of less than half the smaller one's radius.
struct ThinOverlap {
  std::size_t sphere = 0;                              ///< index of the second one
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< between them, map frame
  double distance = 0.0;                               ///< between their centres, metres
  double radius = 0.0;                                 ///< of the circle in which they meet; 0: they do not
};

/// How densely a volume was sampled: distances between the centres of successive spheres. A new stroke that
/// starts elsewhere shows as a pair that does not meet.
struct SampleSpacing {
  double median = 0.0, largest = 0.0;                    ///< metres; 0 for fewer than two spheres
  double median_relative = 0.0, largest_relative = 0.0;  ///< over the smaller sphere's radius
  std::vector<ThinOverlap> thin;                         ///< in the order painted
};

/// Compactness and regularity of one painted volume, the measures of quality of Chong et al. 2008, 4.1.
struct VolumeQuality {
  std::string label;
  std::size_t spheres = 0;
  VolumeBounds exact;      ///< volume of the union of the spheres, m^3
  AreaEstimate surface;    ///< of that union, m^2
  std::size_t voxels = 0;  ///< painted, occupied ones included
  std::size_t occupied = 0;
  double voxel_volume = 0.0;  ///< of the painted voxels, m^3
  SampleSpacing spacing;

  std::string not_searched;          ///< why parts, holes and necks are missing; empty when they are not
  std::vector<std::size_t> parts{};  ///< voxels of each face-connected part, largest first
  std::vector<VolumeHole> holes{};   ///< largest first
  std::vector<VolumeNeck> necks{};   ///< narrowest first

  /// What the voxels do not cover of the exact union, m^3; known to +- exact.half_width().
  double loss() const { return exact.middle() - voxel_volume; }
  /// Area of a sphere of equal volume over the area: 1 for one sphere, less the less compact; 0 for none.
  double sphericity() const;
};

/// How hard measure_volume looks.
struct QualityOptions {
  double relative_width = 2e-3;  ///< of the bounds of the exact volume
  double neck_ratio = 0.8;       ///< a neck is at most this share of the largest sphere of either part
  std::size_t most_cells = std::size_t{1} << 26U;  ///< of the box about the volume, 8 bytes each
};

/// Measures volume `index` of the map. A volume without exact spheres (a bare tree) has no exact figures.
/// @throws std::invalid_argument for an index out of [0, 15) or options out of range.
VolumeQuality measure_volume(const Snapshot& map, int index, const QualityOptions& options = {});

/// Distances between successive spheres.
SampleSpacing sample_spacing(const std::vector<Sphere>& spheres);

}  // namespace clearway
