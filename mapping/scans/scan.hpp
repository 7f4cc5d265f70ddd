#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// A measured cloud together with the pose it was measured from; a cloud never travels without its pose.
struct Scan {
  double time = 0.0;   ///< seconds, all scans of a map by one clock; unknown where it is not finite or beyond
                       ///< SeenStamps::latest_time, as nanoseconds since 1970 are
  std::string sensor;  ///< label, for reports
  Eigen::Isometry3d map_from_sensor = Eigen::Isometry3d::Identity();  ///< the rays start at its origin
  std::vector<Eigen::Vector3f> points;                                ///< sensor frame, metres
  /// Where rays end that met nothing up to there: they free space as hits do, less the same margin (see
  /// SafeMargins::trim), and set no hit. Sensor frame, metres; most scans say nothing of such rays.
  std::vector<Eigen::Vector3f> clear_to{};
  /// Where rays end on what may be the robot, a hand or a thing beside them: no hits, and their rays free
  /// nothing. In safe integration nothing is freed around them, either. Sensor frame, metres.
  std::vector<Eigen::Vector3f> taken_out{};
  /// Where the sensor was is not known: the points set their hits and no ray is cast.
  bool has_hits_only = false;
};

/// A capsule of space, map frame; radius around the segment from `a` to `b`.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// What to leave out of a scan before it is integrated.
struct ScanFilter {
  double min_range = 0.0;  ///< nearer points are dropped, metres
  double max_range = 0.0;  ///< farther points free the ray up to this range and set no hit; 0 = no limit
  /// One ray per cube of this side, to the point nearest to the centroid of its points; 0: one for each
  /// point. In safe integration all of them are hits, in compatible those of the rays alone.
  double thin_to = 0.0;
  int outlier_neighbours = 0;       ///< statistical outlier removal looks at this many neighbours; 0 = off
  double outlier_deviations = 2.0;  ///< and drops points whose mean distance to them exceeds the scan's mean
                                    ///< by more than this many standard deviations
  Eigen::AlignedBox3d crop{};       ///< map frame; points outside are dropped; empty = keep all
  std::vector<Capsule> bodies{};    ///< the robot, the probe and the hand: points inside are taken out
};

/// What became of the points of one scan. `inserted + beyond_range + dropped_*` = points given.
struct ScanCounts {
  std::size_t inserted = 0;
  std::size_t beyond_range = 0;     ///< cleared up to max_range, no hit
  std::size_t dropped_invalid = 0;  ///< NaN, infinite, or outside the key range of the tree
  std::size_t dropped_filter = 0;   ///< by min_range, crop, thinning, as an outlier or in a body
  std::size_t cleared = 0;  ///< rays of Scan::clear_to that were cast; min_range, crop and bodies drop others
  bool origin_invalid = false;  ///< the sensor origin is not finite or outside the tree: nothing inserted
};

}  // namespace clearway
