#pragma once

#include "mapping/system/instruction_set.hpp"

// Private to VoxelDistances: what its loops for registers of each width take and give, in plain numbers.

namespace clearway {

constexpr int distance_lanes = 8;  ///< cubes that are looked at side by side

enum class DistanceKind { round, cylinder, box };

/// A placed body; metres, map frame.
struct DistanceBody {
  double middle[3], axes[3][3];            ///< the axes are those of its own frame, unit
  double half[3];                          ///< edges of a box
  double radius = 0.0, half_length = 0.0;  ///< of what is round
  double size = 0.0;                       ///< of coordinates, for rounding
  double half_edge = 0.0;                  ///< of the cubes
  double enough = 0.0;                     ///< nobody asks how much farther apart they are
};

struct DistanceLanes {
  alignas(64) double center[3][distance_lanes], towards[3][distance_lanes];
  alignas(64) double distance[distance_lanes], point[3][distance_lanes], normal[3][distance_lanes];
  alignas(64) double is_open[distance_lanes];  ///< 1: not found within the looks that were allowed
};

/// The same operations in the same order, and so the same bits, with each instruction set, which the machine
/// must have (see best_instruction_set).
void voxel_distances(DistanceKind kind, const DistanceBody& body, DistanceLanes& lanes,
                     InstructionSet vectors);

}  // namespace clearway
