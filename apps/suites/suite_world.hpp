#pragma once

#include "datasets/descriptions/suite.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

/// The map of a world that is not loaded: scans of its solids, then its paint, stroke by stroke; of an exact
/// one the voxels that its solids meet.
/// Deterministic. @param critical_parts those of volumes that name none (the robot's)
/// @throws std::invalid_argument when the world's figures do not make a map (see FreeSpaceMap).
Snapshot make_map(const SuiteWorld& world, const std::vector<std::string>& critical_parts);

}  // namespace clearway
