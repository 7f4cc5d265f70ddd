#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace clearway {

// Shapes of the command line: "box:X,Y,Z,SX,SY,SZ", "sphere:X,Y,Z,R" and "cylinder:X,Y,Z,R,H", each about its
// middle, a cylinder along z; metres, in the map frame. Of a box and a cylinder YAW or ROLL,PITCH,YAW may
// follow, radians: Rz(yaw) Ry(pitch) Rx(roll).
// All @throws std::invalid_argument in one sentence naming the shape, also when more than 25,000,000 voxels
// would have to be looked at.

/// The centres of the voxels of this edge that a shape meets, also with its surface alone, as suites' solids.
std::vector<Eigen::Vector3d> cells_met(const std::vector<std::string>& shapes, double edge);

/// The centres of the voxels of this edge that lie wholly inside one of the shapes, to 1e-9 of their size.
std::vector<Eigen::Vector3d> cells_inside(const std::vector<std::string>& shapes, double edge);

}  // namespace clearway
