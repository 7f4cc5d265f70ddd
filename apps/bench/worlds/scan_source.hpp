#pragma once

#include <octomap/OcTree.h>

#include <filesystem>
#include <functional>

#include "mapping/scans/scan.hpp"

namespace clearway::bench {

/// Scans one after the other.
struct ScanSource {
  std::function<Scan(std::size_t index)> scan;
  std::size_t count = 0;  ///< index < count

  Scan operator()(std::size_t index) const { return scan(index); }
};

/// The first frames of a camera that goes round in 24: each sees three quarters of what the last one saw.
/// 640 x 480 pixels; through the furnished room, and round a desk (desk_scans).
ScanSource room_frames(std::size_t count);
ScanSource desk_frames(std::size_t count);

/// Turns of a lidar with 64 rings of 1,172 points (75,008) in a hall of 36 x 28 x 6 m, 1.8 m over the floor.
ScanSource lidar_turns(std::size_t count);

/// The scans of a rawlog, or the one of a .pcd or .ply, seen from the file's viewpoint.
/// @throws std::invalid_argument when the file holds none.
ScanSource scans_of(const std::filesystem::path& file);

/// Inserts with octomap::OcTree::insertPointCloud; the CPU seconds of that call alone.
double insert_stock(octomap::OcTree& tree, const Scan& scan, double max_range, bool discretize);

}  // namespace clearway::bench
