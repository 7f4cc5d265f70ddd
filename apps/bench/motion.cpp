// Smooth motion along planned paths against the motion that they had before, edge by edge in trapezoids of
// speed; and what it costs to make.

#include <algorithm>
#include <memory>

#include "apps/bench/bench.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/auto_planner.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t motions_of_each = 2;  ///< of each experiment, spread evenly
constexpr double motion_limit = 0.5;        ///< s to plan

/// A proved path in its space.
struct MotionTask {
  std::shared_ptr<const ConfigurationSpace> space;
  Plan plan;
};

/// Proved paths of one planner.
struct MotionTasks {
  std::shared_ptr<const Planner> planner;
  std::vector<MotionTask> tasks = {};
};

void plan_task(const std::shared_ptr<const ConfigurationSpace>& space, const StageProblem& problem,
               MotionTasks& of) {
  Plan plan = plan_and_check({.space = *space,
                              .start = problem.start,
                              .goals = problem.goals,
                              .planner = of.planner,
                              .time_limit = motion_limit,
                              .survey = std::nullopt,
                              .advice_time = 0.0});
  if (plan.is_proved()) of.tasks.push_back({space, std::move(plan)});
}

void draw_tasks(const BenchOptions& options, MotionTasks& trees, MotionTasks& boundary) {
  for (const char* name : {"quick.yaml", "local.yaml", "guided.yaml"}) {
    const Suite suite = load_suite(datasets_folder() / "suites" / name);
    for (const SuiteExperiment& experiment : suite.experiments) {
      if (experiment.teams) continue;
      options.say("drawing " + experiment.name);
      const Robot robot = load_robot(experiment.robot);
      const SuiteStages stages(suite, experiment, robot);
      const std::size_t wanted = std::min(motions_of_each, stages.size());
      for (std::size_t i = 0; i < wanted; ++i) {
        const SuiteStage stage = stages.make(i * stages.size() / wanted);
        const auto space = std::make_shared<const ConfigurationSpace>(
            robot, stage.map, suite_policies(suite, experiment, robot),
            SpaceOptions{.padding = experiment.padding.value_or(robot.position_accuracy)});
        for (MotionTasks* of : {&trees, &boundary}) plan_task(space, stage.problems.front(), *of);
      }
    }
  }
}

/// Of one planner's paths.
struct Motions {
  std::vector<double> waypoints, ours, peer, cpu_ms, cpu_ms_of_20;  ///< s but for these
  std::size_t valid = 0, stops = 0, passed = 0;
};

void measure(const MotionTask& task, int runs, Motions& motions) {
  std::vector<double> cpu;
  PlannedMotion motion;
  for (int run = 0; run < runs; ++run) {
    motion = plan_motion(*task.space, task.plan);
    cpu.push_back(1e3 * motion.cpu_s);
  }
  const auto waypoints = static_cast<double>(task.plan.waypoints().size());
  motions.waypoints.push_back(waypoints);
  motions.ours.push_back(motion.motion.duration());
  motions.peer.push_back(trajectory_of(task.space->robot(), task.plan).points.back().time);
  motions.cpu_ms.push_back(median(cpu));
  if (waypoints >= 15 && waypoints <= 25) motions.cpu_ms_of_20.push_back(median(cpu));
  motions.valid += motion.validation.valid ? 1 : 0;
  motions.stops += motion.stops;
  motions.passed += motion.blended;
}

Motions measure_all(const std::vector<MotionTask>& tasks, const BenchOptions& options) {
  Motions motions;
  for (const MotionTask& task : tasks) measure(task, options.runs, motions);
  return motions;
}

std::vector<double> ratios_of(const Motions& motions) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < motions.ours.size(); ++i) ratios.push_back(motions.peer[i] / motions.ours[i]);
  return ratios;
}

std::vector<std::string> row_of(const std::string& name, const Motions& motions) {
  const std::size_t corners = motions.stops + motions.passed;
  return {name,
          count_text(static_cast<double>(motions.ours.size())),
          figure(median(motions.waypoints)),
          figure(median(motions.ours)),
          figure(median(motions.peer)),
          figure(median(ratios_of(motions))),
          corners > 0 ? figure(100.0 * double(motions.stops) / double(corners)) + " %" : "-",
          figure(100.0 * double(motions.valid) / double(motions.ours.size())) + " %",
          figure(median(motions.cpu_ms)),
          motions.cpu_ms_of_20.empty() ? "-" : figure(median(motions.cpu_ms_of_20))};
}

nlohmann::ordered_json reported(const Motions& motions) {
  return {{"paths", motions.ours.size()},
          {"waypoints_median", median(motions.waypoints)},
          {"motion_s_median", median(motions.ours)},
          {"edge_by_edge_s_median", median(motions.peer)},
          {"times_as_long_median", median(ratios_of(motions))},
          {"stops", motions.stops},
          {"blended", motions.passed},
          {"valid", motions.valid},
          {"cpu_ms_median", median(motions.cpu_ms)},
          {"cpu_ms_p95", quantile(motions.cpu_ms, 0.95)}};
}

}  // namespace

BenchResult bench_motion(const BenchOptions& options) {
  MotionTasks by_trees{std::make_shared<AutoPlanner>()}, by_boundary{std::make_shared<BoundaryPlus>()};
  draw_tasks(options, by_trees, by_boundary);
  const Motions trees = measure_all(by_trees.tasks, options),
                boundary = measure_all(by_boundary.tasks, options);
  BenchResult result{median(trees.ours),
                     median(trees.peer),
                     "edge by edge, stops and jumps in acceleration",
                     "s of motion along a path of `auto`",
                     true,
                     options.runs,
                     {}};
  result.detail = {{"auto", reported(trees)}, {"boundary_plus", reported(boundary)}};
  result.tables = {{"",
                    {"paths of", "paths", "waypoints", "s, ours", "s, edge by edge", "ratio",
                     "corners with a stop", "valid by the check", "CPU ms to make", "of 15 to 25 waypoints"},
                    {row_of("`auto`", trees), row_of("`boundary_plus`", boundary)}}};
  result.compared =
      "Proved paths of the suites `quick`, `local` and `guided`: how long the arm moves along them "
      "under "
      "limits of velocity, acceleration and jerk, corners blended within what is proved, against the motion "
      "in "
      "trapezoids of speed along each edge under limits of velocity and acceleration alone. Medians over "
      "paths; "
      "the time to make a motion does not hold its check.";
  return result;
}

}  // namespace clearway::bench
