#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/suites/suite_stages.hpp"

namespace clearway {

constexpr std::size_t problems_of_furniture = 4;

/// Where a hand may take hold of something or put it down.
struct GraspPlace {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();        ///< map frame: between the fingers
  Eigen::Vector3d approach = Eigen::Vector3d::Zero();  ///< unit, map frame: the way that the hand points
};

/// Furniture and things about an arm, and queries between places to grasp at.
struct FurnitureScene {
  std::string name;
  std::vector<SceneShape> solids;
  std::vector<GraspPlace> places;
  Snapshot map;  ///< exactly the voxels that the solids meet
  std::vector<StageProblem> problems;
};

/// Solids and places of scene number `index`: of the kinds "thin bookshelf", "tall bookshelf", "cage", "box",
/// "table", "under table" and "kitchen" in turn. Sizes go with the arm's reach, heights with its shoulder.
/// Map and problems are left empty. @param attempt another scene of that number; from the sixth
/// on a cage stands on the floor at least, in which it is before an arm with a low shoulder
FurnitureScene draw_furniture(const Robot& robot, std::uint64_t seed, std::size_t index, int attempt);

/// @throws std::runtime_error for an arm with fewer than six joints
void require_cells(const Robot& robot);

/// Draws scene number `index` of a generator with `problems_of_furniture` problems (the last one with what is
/// left of the generator's count). A goal, and of every second problem the start, holds the tip at a place
/// with the tip's z axis at most 25 degrees off its approach, turned about it anyhow, up to 8 % of the arm's
/// reach before it; the other starts are configurations drawn within the limits. All are free. Of draws that
/// a straight edge seems to solve one in ten is kept. Of a scene that holds no problem another one is drawn.
/// A hand that points another way than z does so for it, and one that reaches deeper than those 8 % beyond
/// the tip is held by its end (hand_at_tip).
/// @param padding metres
/// @throws as require_cells; DrawnInVain (suite_draws.hpp) when ten scenes hold no problem.
FurnitureScene draw_cells(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                          const Policies& policies, double padding);

}  // namespace clearway
