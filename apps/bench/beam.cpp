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

/// What one scene showed.
struct SceneFigures {
  BeamRun ours, peer;
  Json detail;
};

SceneFigures measure_scene(const BeamScene& scene, const BenchOptions& options) {
  const PlannerOptions compared = {{"width", "20"}};  // at which both run
  const ConfigurationSpace space(scene.robot, scene.map);
  SceneFigures figures;
  figures.detail["voxels"] = scene_voxels(scene);
  options.say(scene.name + ", widths");
  figures.detail["widths"] = beam_widths(space, scene, options.runs);
  options.say(scene.name + ", memory");
  figures.detail["memory"] = beam_memory(space, scene);
  options.say(scene.name + ", beam_reference");
  figures.ours = run_beam("beam", compared, space, scene, options.runs);
  figures.peer = run_beam("beam_reference", compared, space, scene, 1);
  if (figures.ours.result.waypoints != figures.peer.result.waypoints ||
      figures.ours.result.cost != figures.peer.result.cost)
    throw std::logic_error("beam and beam_reference differ");
  figures.detail["beam_k_20"] = described(figures.ours);
  figures.detail["beam_reference_k_20"] = described(figures.peer);
  figures.detail["ratio_k_20"] = figures.peer.ms / figures.ours.ms;
  options.say(scene.name + ", deadlines");
  figures.detail["worst_ms_past_a_deadline_k_100"] = worst_overshoot(space, scene);
  return figures;
}

std::string bytes_text(const Json& memory) {
  double least = 1e99, most = 0.0;
  for (const Json& row : memory) {
    least = std::min(least, row["bytes_over_k_h"].get<double>());
    most = std::max(most, row["bytes_over_k_h"].get<double>());
  }
  return figure(least) + " to " + figure(most);
}

std::string shown_name(const std::string& scene) { return scene == "holed" ? "round a pocket" : scene; }

/// Scenes down, widths across.
Table width_table(const Json& detail) {
  Table table{"CPU ms per query:",
              {"volume", "k = 1", "10", "20", "50", "100", "`beam_reference`, k = 20, one run", "ratio"},
              {}};
  for (const char* name : {"compact", "holed"}) {
    const Json& scene = detail[name];
    std::vector<std::string> row{shown_name(name)};
    for (const Json& width : scene["widths"]) row.push_back(figure(width["ms"].get<double>()));
    row.push_back(figure(scene["beam_reference_k_20"]["ms"].get<double>()));
    row.push_back(figure(scene["ratio_k_20"].get<double>()));
    table.rows.push_back(row);
  }
  return table;
}

Table growth_table(const Json& detail) {
  Table table{"",
              {"volume", "time per step over k log k at k = 100 (k = 10: 1)", "peak heap over k h, bytes",
               "late after a deadline, k = 100, ms"},
              {}};
  for (const char* name : {"compact", "holed"}) {
    const Json& scene = detail[name];
    table.rows.push_back(
        {shown_name(name), figure(scene["widths"].back()["of_k_log_k_from_10"].get<double>()),
         bytes_text(scene["memory"]), figure(scene["worst_ms_past_a_deadline_k_100"].get<double>())});
  }
  return table;
}

Table joints_table(const Json& joints) {
  Table table{"Like scenes, k = 20:", {"robot", "joints", "us per step", "of six joints"}, {}};
  for (const Json& row : joints)
    table.rows.push_back({row["robot"].get<std::string>(), std::to_string(row["joints"].get<int>()),
                          figure(row["us_a_step"].get<double>()),
                          figure(row["of_six_joints"].get<double>())});
  return table;
}

}  // namespace

BenchResult bench_beam(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.01;
  BenchResult result{0, 0, "beam_reference", "CPU ms per query", true, options.runs, {}};
  Json detail{{"resolution", resolution}};
  for (const auto& [name, make] : {std::pair{"compact", &compact_scene}, {"holed", &holed_scene}}) {
    options.say(std::string("making the scene ") + name);
    const SceneFigures figures = measure_scene(make(resolution), options);
    detail[name] = figures.detail;
    if (result.ours > 0.0) continue;
    result.ours = figures.ours.ms;
    result.peer = figures.peer.ms;
  }
  options.say("joints");
  detail["joints"] = beam_joints(resolution, options.runs);
  result.compared =
      "A PUMA 560 in a painted volume of a scanned room, " +
      figure(1e-6 * detail["compact"]["voxels"].get<double>()) + " million voxels at " +
      length_text(resolution) +
      ", compact or round an unpainted pocket of 8 cm: `beam` against `beam_reference`, its literal "
      "expansion, which is ours, too; path and cost are equal bit for bit.";
  result.tables = {width_table(detail), growth_table(detail), joints_table(detail["joints"])};
  result.detail = std::move(detail);
  return result;
}

}  // namespace clearway::bench
