#pragma once

#include <string>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// A sphere of space that, shown to be free, would let a part through.
struct PaintHint {
  Sphere sphere;  ///< map frame, metres
  std::string part;
};

/// Where painting more would connect start and goal.
struct PaintAdvice {
  std::vector<PaintHint> spheres;  ///< in the order of the way; empty: nothing to advise
  bool way_exists = false;         ///< beam_guided found a path that needs no more paint

  /// "Painting would connect start and goal: 140 mm around (0.310, -0.120, 0.420) for tool, ...". Empty when
  /// there is nothing to say.
  std::string sentence() const;
};

/// First `beam_guided`, unless it is the planner, is asked whether there is a path as things are. Then looks
/// for a path where every part that has to stay in painted or known space may enter unknown space, too
/// (never occupied voxels or conflicts). Two are tried: the same planner's, for it is this planner that is to
/// succeed, and one along the cheapest route for the hand, where a metre outside the paint costs as much as
/// thirty inside. Every part that leaves its space on the way asks for spheres that hold it there, larger by
/// the padding and three and a quarter voxels, because only voxels wholly inside a sphere are painted. Of the
/// two ways the planner's own is advised, unless it is not found or the other needs less than half as many
/// spheres and the planner does not move on a lattice of its own (`follows_lattice`).
/// @param problem as it was asked, and failed; its deadline holds for the search here.
PaintAdvice advise_paint(const Planner& planner, const PlanProblem& problem, bool follows_lattice);

}  // namespace clearway
