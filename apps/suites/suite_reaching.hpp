#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "apps/suites/suite_stages.hpp"

namespace clearway {

constexpr std::size_t problems_of_a_scene = 10;

/// A box that the tip of an arm has to reach into, axes as those of its frame.
struct TipRegion {
  Eigen::Isometry3d map_from_region = Eigen::Isometry3d::Identity();
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< m, in its frame
  Eigen::Vector3d approach = Eigen::Vector3d::Zero();  ///< unit, in its frame; zero: from anywhere
};

/// Obstacles before an arm, as sensors see them, and queries from one region of the tip to another.
struct ReachingScene {
  SuiteWorld world;                ///< solids and sensors
  Snapshot map;                    ///< what the sensors saw of it
  std::vector<TipRegion> regions;  ///< empty: any configuration is a start or a goal
  std::vector<StageProblem> problems;
};

/// What the tip of an arm can reach, from a few thousand seeded configurations.
struct ArmReach {
  double length = 0.0;  ///< m: the farthest from the axis of the base
  double height = 0.0;  ///< m over the base: where that is
};
ArmReach arm_reach(const Robot& robot);

/// Solids, sensors and tip regions of a kind of scene, drawn for an arm of that reach: "shelf" (three by
/// three compartments), "table" (things standing on it), "ladder" (two rails and rungs), "cage" (a frame of
/// bars) or "boxes" (floating anywhere). Map, problems and the world's name are left empty.
/// @throws std::invalid_argument for another kind.
ReachingScene draw_obstacles(std::string_view kind, const Robot& robot, const ArmReach& reach,
                             std::uint64_t seed, std::size_t index);

/// Draws scene number `index` of a generator of one of these kinds, with `problems_of_a_scene` problems (the
/// last one with what is left of the generator's count). Start and goal hold the tip in two different
/// regions, at most 50 degrees off the region's approach; both are free, the straight edge between them is
/// not. One goal in two is sought from the start's configuration, the others from half-way to a random one.
/// @param padding metres
/// @throws std::runtime_error when 50,000 draws hold no such problem.
ReachingScene draw_reaching(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                            const Policies& policies, double padding);

}  // namespace clearway
