// Beam search: `beam` against its literal expansion `beam_reference`, same problem and same result, bit for
// bit; and what it costs as the beam grows wider.

#include <algorithm>
#include <stdexcept>

#include "apps/bench/beam_scenes.hpp"
#include "apps/bench/bench.hpp"
#include "planning/planner.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Run {
  PlanResult result;
  double ms = 0.0;  ///< CPU, median
};

Run plan(const std::string& planner, int width, const ConfigurationSpace& space, const BeamScene& scene,
         int runs) {
  const PathCost cost(scene.robot);
  const auto search = make_planner(planner, {{"width", std::to_string(width)}});
  Run run;
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    times.push_back(1e3 * cpu_seconds([&] {
                      run.result = search->plan({space, cost, scene.start, scene.goal});
                    }));
  }
  run.ms = median(times);
  return run;
}

Json described(const Run& run) {
  return {{"status", to_string(run.result.status)},
          {"ms", run.ms},
          {"steps", run.result.search_steps},
          {"cost_joules", run.result.cost},
          {"configurations_checked", run.result.configurations_checked},
          {"edges_checked", run.result.edges_checked}};
}

/// How long after its deadline a wide beam comes back at worst, over deadlines of 5 to 100 ms, wall-clock ms.
double worst_overshoot(const ConfigurationSpace& space, const BeamScene& scene) {
  const PathCost cost(scene.robot);
  const auto search = make_planner("beam", {{"width", "100"}});
  double worst = 0.0;
  for (int i = 1; i <= 20; ++i) {
    const double deadline = wall_time() + 5e-3 * i;
    search->plan({space, cost, scene.start, scene.goal, 1, [&] { return wall_time() >= deadline; }});
    worst = std::max(worst, 1e3 * (wall_time() - deadline));
  }
  return worst;
}

std::size_t voxels(const Snapshot& map) {
  const VoxelCounts counts = map.counts();
  return counts.painted + counts.seen_free + counts.occupied + counts.conflict;
}

}  // namespace

BenchResult bench_beam(const BenchOptions& options) {
  constexpr int compared = 20;  ///< width at which both run
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.01;
  Json detail{{"resolution", resolution}};
  Run headline, headline_peer;
  for (const BeamScene& scene : {compact_scene(resolution), holed_scene(resolution)}) {
    const ConfigurationSpace space(scene.robot, scene.map);
    Json& row = detail[scene.name];
    row["voxels"] = voxels(scene.map);
    for (const int width : {1, 5, 10, 20, 50, 100})
      row["k_" + std::to_string(width)] = described(plan("beam", width, space, scene, options.runs));
    const Run ours = plan("beam", compared, space, scene, options.runs);
    const Run peer = plan("beam_reference", compared, space, scene, 1);
    if (ours.result.waypoints != peer.result.waypoints || ours.result.cost != peer.result.cost)
      throw std::logic_error("beam and beam_reference differ");
    row["beam_reference_k_20"] = described(peer);
    row["ratio_k_20"] = peer.ms / ours.ms;
    row["worst_ms_past_a_deadline_k_100"] = worst_overshoot(space, scene);
    if (scene.name == "compact") headline = ours, headline_peer = peer;
  }
  return {headline.ms, headline_peer.ms, "beam_reference", "CPU ms a query", true, options.runs, detail};
}

}  // namespace clearway::bench
