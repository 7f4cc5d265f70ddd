// What a beam search costs as joints, width and length grow.

#include "apps/bench/beam_growth.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "planning/planner_table.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

double search_heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

}  // namespace

double scene_voxels(const BeamScene& scene) {
  const VoxelCounts counts = scene.map.counts();
  return static_cast<double>(counts.painted + counts.seen_free + counts.occupied + counts.conflict);
}

BeamRun run_beam(const std::string& planner, const PlannerOptions& options, const ConfigurationSpace& space,
                 const BeamScene& scene, int runs) {
  const PathCost cost(scene.robot);
  const auto search = make_planner(planner, options);
  BeamRun run;
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    times.push_back(1e3 * cpu_seconds([&] {
                      run.result = search->plan({space, cost, scene.start, scene.goal});
                    }));
  }
  run.ms = median(times);
  run.steps = run.result.statistics["steps_searched"];
  return run;
}

Json beam_joints(double resolution, int runs) {
  struct Task {
    BeamScene scene;
    ConfigurationSpace space;
    std::vector<double> ms{};
    BeamRun run{};
    explicit Task(BeamScene made) : scene(std::move(made)), space(scene.robot, scene.map) {}
  };
  std::vector<std::unique_ptr<Task>> tasks;
  for (const auto& make : {compact_scene, seven_joint_scene, ten_joint_scene})
    tasks.push_back(std::make_unique<Task>(make(resolution)));
  for (int i = 0; i < 3 * runs; ++i) {  // interleaved
    for (const auto& task : tasks) {
      task->run = run_beam("beam", {{"width", "20"}}, task->space, task->scene, 1);
      task->ms.push_back(task->run.ms);
    }
  }
  Json rows;
  for (const auto& task : tasks) {
    BeamRun& run = task->run;
    if (run.result.status != PlanStatus::solved)
      throw std::logic_error(task->scene.name + ": " + run.result.explanation);
    run.ms = median(task->ms);
    rows.push_back(
        {{"joints", task->scene.robot.dof()},
         {"robot", task->scene.robot.name},
         {"voxels", scene_voxels(task->scene)},
         {"steps", run.steps},
         {"ms", run.ms},
         {"us_a_step", run.us_a_step()},
         {"of_six_joints", run.us_a_step() / tasks.front()->run.us_a_step()},
         {"neighbours_a_step", run.result.statistics.at("neighbours_generated") / run.steps},
         {"configurations_a_step", static_cast<double>(run.result.configurations_checked) / run.steps}});
  }
  return rows;
}

Json beam_widths(const ConfigurationSpace& space, const BeamScene& scene, int runs) {
  Json rows;
  double ten = 0.0;
  for (const int width : {1, 10, 20, 50, 100}) {
    const BeamRun run = run_beam("beam", {{"width", std::to_string(width)}}, space, scene, runs);
    const double law = width * std::log2(width);
    if (width == 10) ten = run.us_a_step() / law;
    rows.push_back({{"k", width},
                    {"ms", run.ms},
                    {"status", to_string(run.result.status)},
                    {"steps", run.steps},
                    {"us_a_step", run.us_a_step()},
                    {"cost_joules", run.result.cost}});
    if (width >= 10) rows.back()["of_k_log_k_from_10"] = run.us_a_step() / law / ten;
  }
  return rows;
}

/// The heap is looked at whenever the search asks for the time, which it does many times a step.
Json beam_memory(const ConfigurationSpace& space, const BeamScene& scene) {
  const PathCost cost(scene.robot);
  Json rows;
  for (const double step_deg : {0.5, 0.25, 0.125}) {
    for (const int width : {10, 20, 50, 100}) {
      const auto search =
          make_planner("beam", {{"width", std::to_string(width)}, {"step_deg", std::to_string(step_deg)}});
      malloc_trim(0);
      const double before = search_heap_bytes();
      double most = before;
      int asked = 0;
      PlanProblem problem{space, cost, scene.start, scene.goal};
      problem.out_of_time = [&] {
        if (++asked % 16 == 0) most = std::max(most, search_heap_bytes());
        return false;
      };
      PlanResult result = search->plan(problem);
      const double bytes = most - before, heads = result.statistics["heads"];
      const double length = result.statistics["steps_searched"];
      rows.push_back({{"k", width},
                      {"h", length},
                      {"heads", heads},
                      {"heap_high_water", bytes},
                      {"bytes_a_head", bytes / heads},
                      {"bytes_over_k_h", bytes / (width * length)}});
    }
  }
  return rows;
}

}  // namespace clearway::bench
