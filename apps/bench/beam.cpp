// Beam search: `beam` against its literal expansion `beam_reference`, same problem and same result, bit for
// bit; and what it costs as the beam grows wider and longer and the robot has more joints.

#include <algorithm>
#include <stdexcept>

#include "apps/bench/beam_growth.hpp"
#include "apps/bench/bench.hpp"
#include "planning/planner_table.hpp"
#include "planning/problem/planner.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

Json described(const BeamRun& run) {
  return {{"status", to_string(run.result.status)},
          {"ms", run.ms},
          {"steps", run.result.search_steps},
          {"us_a_step", run.us_a_step()},
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
  const PlannerOptions compared = {{"width", "20"}};  ///< at which both run
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.01;
  Json detail{{"resolution", resolution}};
  BeamRun headline, headline_peer;
  for (const BeamScene& scene : {compact_scene(resolution), holed_scene(resolution)}) {
    const ConfigurationSpace space(scene.robot, scene.map);
    Json& row = detail[scene.name];
    row["voxels"] = voxels(scene.map);
    row["widths"] = beam_widths(space, scene, options.runs);
    row["memory"] = beam_memory(space, scene);
    const BeamRun ours = run_beam("beam", compared, space, scene, options.runs);
    const BeamRun peer = run_beam("beam_reference", compared, space, scene, 1);
    if (ours.result.waypoints != peer.result.waypoints || ours.result.cost != peer.result.cost)
      throw std::logic_error("beam and beam_reference differ");
    row["beam_k_20"] = described(ours);
    row["beam_reference_k_20"] = described(peer);
    row["ratio_k_20"] = peer.ms / ours.ms;
    row["worst_ms_past_a_deadline_k_100"] = worst_overshoot(space, scene);
    if (scene.name == "compact") headline = ours, headline_peer = peer;
  }
  detail["joints"] = beam_joints(resolution, options.runs);
  return {headline.ms, headline_peer.ms, "beam_reference", "CPU ms a query", true, options.runs, detail};
}

}  // namespace clearway::bench
