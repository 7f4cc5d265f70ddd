#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway::evidence {

/// Does a body reach deeper than `depth` metres into a voxel that its policy forbids, at one of `samples`
/// places of an edge? Brute force, in code that neither planners nor check share: every voxel round the body,
/// its state as the map reports it, FCL's `collide` with the voxel's cube shrunk by `depth` on each side.
/// Bodies that no joint moves do not count, nor does padding. Shapes other than hulls.
bool is_violated(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 const std::vector<Configuration>& path, double depth, int samples);

}  // namespace clearway::evidence
