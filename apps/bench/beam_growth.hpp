#pragma once

#include <nlohmann/json.hpp>

#include "apps/bench/worlds/beam_scenes.hpp"
#include "planning/problem/planner.hpp"

namespace clearway::bench {

/// One query, some times over.
struct BeamRun {
  PlanResult result;
  double ms = 0.0;     ///< CPU, median
  double steps = 0.0;  ///< searched, also after the first path was found

  double us_a_step() const { return steps > 0.0 ? 1e3 * ms / steps : 0.0; }
};

/// Known voxels of its map.
double scene_voxels(const BeamScene& scene);

BeamRun run_beam(const std::string& planner, const PlannerOptions& options, const ConfigurationSpace& space,
                 const BeamScene& scene, int runs);

/// How the time of `beam` grows with the number of joints, 6, 7 and 10 in like scenes, and with k; and its
/// memory against k h, h being the steps searched.
nlohmann::ordered_json beam_joints(double resolution, int runs);
nlohmann::ordered_json beam_widths(const ConfigurationSpace& space, const BeamScene& scene, int runs);
nlohmann::ordered_json beam_memory(const ConfigurationSpace& space, const BeamScene& scene);

}  // namespace clearway::bench
