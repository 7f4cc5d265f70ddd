#pragma once

#include <string>

#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway::bench {

/// A task for planners: a map with a painted volume, and one query in it.
struct BeamScene {
  std::string name;
  Robot robot;
  Snapshot map;
  Configuration start, goal;
};

/// As scenario 1 of Chong et al. 2008: a full-size PUMA 560 in a scanned room, its tool in a compact painted
/// volume whose border the straight way does not touch. @param resolution metres.
BeamScene compact_scene(double resolution);

/// As scenario 3: the same with a pocket of 8 cm radius that was not painted, in the middle of the straight
/// way.
BeamScene holed_scene(double resolution);

/// As compact_scene, the same turns about the like joints: `panda`, and `panda` on three sliding joints.
BeamScene seven_joint_scene(double resolution);
BeamScene ten_joint_scene(double resolution);

}  // namespace clearway::bench
