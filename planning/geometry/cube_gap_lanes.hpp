#pragma once

// Private to CubeGaps: what its loops for registers of each width take and give, in plain numbers.

namespace clearway {

constexpr int gap_lanes = 8;  ///< cubes that are looked at side by side

enum class GapKind { round, cylinder, box };

/// A placed body; metres, map frame.
struct GapBody {
  double middle[3], axes[3][3];            ///< the axes are those of its own frame, unit
  double half[3];                          ///< edges of a box
  double radius = 0.0, half_length = 0.0;  ///< of what is round
  double size = 0.0;                       ///< of coordinates, for rounding
  double half_edge = 0.0;                  ///< of the cubes
  double enough = 0.0;                     ///< nobody asks how much farther apart they are
};

struct GapLanes {
  alignas(64) double center[3][gap_lanes], towards[3][gap_lanes];
  alignas(64) double distance[gap_lanes], point[3][gap_lanes], normal[3][gap_lanes];
  alignas(64) double is_open[gap_lanes];  ///< 1: not found within the looks that were allowed
};

// The same operations in the same order, and so the same bits, in four and in eight lanes. Call them only on
// a machine that has those registers (see widest_vectors).
void cube_gaps_portable(GapKind kind, const GapBody& body, GapLanes& lanes);
void cube_gaps_avx2(GapKind kind, const GapBody& body, GapLanes& lanes);
void cube_gaps_avx512(GapKind kind, const GapBody& body, GapLanes& lanes);

}  // namespace clearway
