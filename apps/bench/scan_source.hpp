#pragma once

#include <octomap/OcTree.h>

#include <filesystem>
#include <functional>

#include "mapping/scans/scan.hpp"

namespace clearway::bench {

/// Scan `index` of a sequence; sequences go round, so that any index is good.
using ScanSource = std::function<Scan(std::size_t index)>;

/// Depth frames of a walk round the furnished room, 640 x 480 pixels each.
ScanSource room_frames(std::size_t frames);

/// Depth frames round a desk (desk_scans).
ScanSource desk_frames(std::size_t frames);

/// Turns of a lidar with 64 rings of 1,172 points (75,008) in a hall of 36 x 28 x 6 m, 1.8 m over the floor.
ScanSource lidar_turns();

/// The scans of a rawlog, or the one of a .pcd or .ply, seen from the file's viewpoint.
/// @throws std::invalid_argument when the file holds none.
ScanSource scans_of(const std::filesystem::path& file);

/// Inserts with octomap::OcTree::insertPointCloud; the CPU seconds of that call alone.
double insert_stock(octomap::OcTree& tree, const Scan& scan, double max_range, bool discretize);

}  // namespace clearway::bench
