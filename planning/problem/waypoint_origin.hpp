#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// What a planner did on the edge that leads to a waypoint.
enum class PathPhase {
  unknown,
  free_motion,   ///< the local method's own step towards the goal
  boundary,      ///< a step along a boundary
  start_tree,    ///< an edge of the tree that grows from the start, or the one that joins both
  goal_tree,     ///< an edge of the tree that grows from the goal
  lattice,       ///< a step of a beam search
  last_segment,  ///< from the lattice to the exact goal
  shortened      ///< a shortcut, a straightened or a rounded part: no edge of what the search found
};
std::string_view to_string(PathPhase phase);
/// The phase of that name; unknown for another name.
PathPhase path_phase(std::string_view name);

/// How a planner came to a waypoint from the one before it.
struct WaypointOrigin {
  PathPhase phase = PathPhase::unknown;
  std::string constraint{};  ///< along a boundary: what was followed, "tool near what blocks it"
  /// When the search made the edge, counted from 1: the depth of a beam, the node of a tree, the step of
  /// the local method. 0: not known.
  int search_step = 0;

  friend bool operator==(const WaypointOrigin&, const WaypointOrigin&) = default;
};

}  // namespace clearway
