// Whole queries, from free ends to a path: `rrtconnect` and `auto`, whose paths are proved everywhere,
// against OMPL's RRT-Connect with FCL's shapes on an fcl::OcTree; in a map that is known, in one that a depth
// frame has just changed, and in one that was never asked.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "apps/bench/bench.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/continued_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "planning/auto_planner.hpp"
#include "planning/check/path_check.hpp"
#include "planning/geometry/turn_between.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/fcl_planners.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t problems_of_each = 3;  ///< of each experiment, spread evenly
constexpr std::uint64_t seeds = 3;           ///< a planner's luck on one problem says little
constexpr double limit = 0.25;               ///< s a query; what is not solved by then counts as that
constexpr double valid_peer_limit = 0.75;    ///< the same of the peer whose paths are mostly valid, one seed
constexpr double valid_resolution = 0.0003;  ///< of that peer: some 95 % of its paths are valid
constexpr double slow = 20.0;                ///< ms: is not asked over and over

/// One problem, its map, and the same map after one more depth frame.
struct Task {
  std::string experiment;
  Robot robot;
  Policies policies;
  SpaceOptions options;
  Snapshot before, after;
  Configuration start, goal;

  ConfigurationSpace space(const Snapshot& map) const { return {robot, map, policies, options}; }
};

bool is_free_at_ends(const ConfigurationSpace& space, const Configuration& start, const Configuration& goal) {
  return space.is_free(start) && space.is_free(goal);
}

/// What a camera at `eye` sees of a ball: a cap of it, some 2,000 points.
Scan frame_of_ball(const Eigen::Vector3d& eye, const Sphere& ball) {
  constexpr int side = 45;
  Scan scan;
  scan.map_from_sensor = Eigen::Translation3d(eye);
  const Eigen::Quaterniond turn = turn_between(Eigen::Vector3d::UnitZ(), eye - ball.center);
  for (int i = 0; i < side * side; ++i) {
    const double away = 0.5 * std::numbers::pi * std::sqrt((i + 0.5) / (side * side));
    const double around = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
    const Eigen::Vector3d way(std::sin(away) * std::cos(around), std::sin(away) * std::sin(around),
                              std::cos(away));
    scan.points.emplace_back((ball.center + ball.radius * (turn * way) - eye).cast<float>());
  }
  return scan;
}

/// The map after a frame that sees a ball which was not there, somewhere in reach but at neither end.
std::optional<Snapshot> changed_map(const Task& task, std::mt19937_64& random) {
  const double reach = 0.8;
  for (int trial = 0; trial < 20; ++trial) {
    const auto draw = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
    };
    const double angle = draw(0.0, 2.0 * std::numbers::pi), away = draw(0.4, 1.0) * reach;
    const Eigen::Vector3d base = task.robot.map_from_base.translation();
    const Eigen::Vector3d center =
        base + Eigen::Vector3d(away * std::cos(angle), away * std::sin(angle), draw(0.2, reach));
    ContinuedMap map(task.before, {.resolution = task.before.resolution(), .hit_probability = 0.9});
    map.insert(frame_of_ball(center + Eigen::Vector3d(0.0, 0.0, 1.0), {center, 0.06}));
    const Snapshot after = map.snapshot();
    if (is_free_at_ends(task.space(after), task.start, task.goal)) return after;
  }
  return std::nullopt;
}

/// A problem of an experiment.
Task task_of(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot,
             const SuiteStage& stage, std::mt19937_64& random) {
  const StageProblem& problem = stage.problems.front();
  Task task{experiment.name,
            robot,
            suite_policies(suite, experiment, robot),
            {.padding = experiment.padding.value_or(robot.position_accuracy)},
            stage.map,
            stage.map,
            problem.start,
            problem.goals.front()};
  if (const auto after = changed_map(task, random)) task.after = *after;
  return task;
}

std::vector<Task> draw_tasks(const BenchOptions& options) {
  std::vector<Task> tasks;
  for (const char* name : {"cells.yaml", "guided.yaml"}) {
    const Suite suite = load_suite(datasets_folder() / "suites" / name);
    for (const SuiteExperiment& experiment : suite.experiments) {
      if (!experiment.generate) continue;
      options.say("drawing " + experiment.name);
      const Robot robot = load_robot(experiment.robot);
      const SuiteStages stages(suite, experiment, robot);
      std::mt19937_64 random(1);
      const std::size_t wanted = std::min(problems_of_each, stages.size());
      for (std::size_t i = 0; i < wanted; ++i)
        tasks.push_back(task_of(suite, experiment, robot, stages.make(i * stages.size() / wanted), random));
    }
  }
  return tasks;
}

struct Answer {
  double ms = 0.0;
  std::vector<Configuration> path;  ///< empty: not solved
};

Answer ask(const Planner& planner, const Task& task, const ConfigurationSpace& space, std::uint64_t seed,
           double within = limit) {
  const PathCost cost(task.robot);
  // Planners ask for the time thousands of times: the wall's takes a twentieth of what the CPU's takes.
  const auto latest = std::chrono::steady_clock::now() + std::chrono::duration<double>(within);
  const double begin = cpu_time();
  PlanResult result = planner.plan(
      {space, cost, task.start, task.goal, seed, [&] { return std::chrono::steady_clock::now() > latest; }});
  const double took = cpu_time() - begin;
  return {1e3 * (result.waypoints.empty() ? std::max(took, within) : took), std::move(result.waypoints)};
}

/// A planner on all tasks, with each seed.
struct Times {
  std::vector<double> warm, changed;  ///< CPU ms of each query
  std::size_t asked = seeds;          ///< of a task, one after the other
  std::size_t solved = 0, valid = 0;

  double valid_share() const { return solved > 0 ? double(valid) / double(solved) : 0.0; }
};

void judge(const Task& task, const ConfigurationSpace& space, const Answer& answer, Times& times) {
  if (answer.path.empty()) return;
  ++times.solved;
  times.valid +=
      check_path(task.robot, task.before, space.policies(), task.options.padding, answer.path, 0.0).valid;
}

/// The changed map as if it had just come: with the fields of the map before, and none of its own.
Snapshot just_changed(const Task& task) {
  return {std::make_shared<const FusedTree>(task.after.tree()), task.after.volumes(), task.before};
}

/// Ours, on one query: medians of `runs`.
void measure_ours(const Task& task, const Planner& planner, std::uint64_t seed, int runs, Times& times) {
  const ConfigurationSpace known = task.space(task.before);
  const Answer first = ask(planner, task, known, seed);  // looks at the map before, too
  judge(task, known, first, times);
  if (first.path.empty()) {
    times.warm.push_back(first.ms);
    times.changed.push_back(first.ms);
    return;
  }
  const auto after_frame = [&] {
    const Snapshot changed = just_changed(task);
    const double begin = cpu_time();
    const ConfigurationSpace space = task.space(changed);
    ask(planner, task, space, seed);
    return 1e3 * (cpu_time() - begin);
  };
  after_frame();  // of a camera's frames the first is none of many
  std::vector<double> warm, changed;
  for (int run = 0; run < (first.ms > slow ? 1 : runs); ++run) {
    warm.push_back(ask(planner, task, known, seed).ms);
    changed.push_back(after_frame());
  }
  times.warm.push_back(median(warm));
  times.changed.push_back(median(changed));
}

Times measure_ours(const std::vector<Task>& tasks, const Planner& planner, int runs) {
  Times times;
  for (const Task& task : tasks)
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) measure_ours(task, planner, seed, runs, times);
  return times;
}

/// Ours on maps of one voxel size that hold nothing but their voxels, CPU ms.
struct FirstTimes {
  std::vector<double> answers;        ///< of the first configuration that is asked
  std::vector<double> trees, chosen;  ///< of the first query, by rrtconnect and auto
};

/// The map before, without what any query derived from it.
Snapshot as_loaded(const Task& task) {
  return {std::make_shared<const FusedTree>(task.before.tree()), task.before.volumes()};
}

double ms_of_first_answer(const Task& task) {
  const Snapshot map = as_loaded(task);
  const double begin = cpu_time();
  task.space(map).is_free(task.start);
  return 1e3 * (cpu_time() - begin);
}

double ms_of_first_query(const Task& task, const Planner& planner, std::uint64_t seed) {
  const Snapshot map = as_loaded(task);
  const double begin = cpu_time();
  ask(planner, task, task.space(map), seed);
  return 1e3 * (cpu_time() - begin);
}

/// By voxel size, metres. The robots were asked before.
std::map<double, FirstTimes> measure_first(const std::vector<Task>& tasks) {
  std::map<double, FirstTimes> of_size;
  for (const Task& task : tasks)
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      FirstTimes& times = of_size[task.before.resolution()];
      times.answers.push_back(ms_of_first_answer(task));
      times.trees.push_back(ms_of_first_query(task, RrtConnect(), seed));
      times.chosen.push_back(ms_of_first_query(task, AutoPlanner(), seed));
    }
  return of_size;
}

std::vector<std::vector<std::string>> rows_of(const std::map<double, FirstTimes>& first) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [size, times] : first)
    rows.push_back({figure(1e3 * size) + " mm", count_text(double(times.answers.size())),
                    figure(median(times.answers)), figure(median(times.trees)),
                    figure(quantile(times.trees, 0.95)), figure(median(times.chosen)),
                    figure(quantile(times.chosen, 0.95))});
  return rows;
}

nlohmann::ordered_json reported(const std::map<double, FirstTimes>& first) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [size, times] : first)
    json.push_back({{"resolution_m", size},
                    {"first_answer_ms", median(times.answers)},
                    {"rrtconnect_median_ms", median(times.trees)},
                    {"rrtconnect_p95_ms", quantile(times.trees, 0.95)},
                    {"auto_median_ms", median(times.chosen)},
                    {"auto_p95_ms", quantile(times.chosen, 0.95)}});
  return json;
}

struct Peer {
  double resolution =
      RrtConnectFclOptions().resolution;  ///< of the space's extent, at which it looks at edges
  std::size_t seeds = bench::seeds;
  double limit = bench::limit;  ///< s
};

/// Its tree of the changed map is part of the time, our fields, which judge its ends, are not.
Times measure_peer(const std::vector<Task>& tasks, const Peer& peer) {
  Times times;
  times.asked = peer.seeds;
  for (const Task& task : tasks) {
    const RrtConnectFcl planner({.resolution = peer.resolution});
    const ConfigurationSpace known = task.space(task.before);
    ask(planner,
        {task.experiment, task.robot, task.policies, task.options, task.before, task.before, task.start,
         task.start},
        known, 1);  // makes its tree
    for (std::uint64_t seed = 1; seed <= peer.seeds; ++seed) {
      const Answer answer = ask(planner, task, known, seed, peer.limit);
      times.warm.push_back(answer.ms);
      judge(task, known, answer, times);
      const ConfigurationSpace changed = task.space(just_changed(task));
      is_free_at_ends(changed, task.start, task.goal);
      times.changed.push_back(
          ask(RrtConnectFcl({.resolution = peer.resolution}), task, changed, seed, peer.limit).ms);
    }
  }
  return times;
}

/// Of as many seeds of each task as another planner was asked.
std::vector<double> of_seeds(const std::vector<double>& list, std::size_t asked) {
  std::vector<double> some;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (i % seeds < asked) some.push_back(list[i]);
  return some;
}

/// @param ours times of rrtconnect with all seeds
std::vector<std::string> row_of(const std::string& name, const Times& times, const std::vector<double>& list,
                                const std::vector<double>& ours) {
  return {name,
          figure(median(list)),
          figure(quantile(list, 0.95)),
          figure(100.0 * double(times.solved) / double(list.size())) + " %",
          times.solved > 0 ? figure(100.0 * times.valid_share()) + " %" : "-",
          figure(median(list) / median(of_seeds(ours, times.asked)))};
}

nlohmann::ordered_json reported(const Times& times) {
  nlohmann::ordered_json json{{"median_ms", median(times.warm)},
                              {"p95_ms", quantile(times.warm, 0.95)},
                              {"solved", times.solved},
                              {"valid", times.valid}};
  if (times.changed.empty()) return json;
  json["cold_median_ms"] = median(times.changed);
  json["cold_p95_ms"] = quantile(times.changed, 0.95);
  return json;
}

}  // namespace

BenchResult bench_plan(const BenchOptions& options) {
  const std::vector<Task> tasks = draw_tasks(options);
  options.say("ours");
  const Times trees = measure_ours(tasks, RrtConnect(), options.runs);
  const Times chosen = measure_ours(tasks, AutoPlanner(), options.runs);
  const std::map<double, FirstTimes> first = measure_first(tasks);
  options.say("peer at its default resolution");
  const Times peer = measure_peer(tasks, Peer());
  options.say("peer at " + figure(valid_resolution));
  const Times valid_peer =
      measure_peer(tasks, {.resolution = valid_resolution, .seeds = 1, .limit = valid_peer_limit});
  BenchResult result{median(trees.warm),
                     median(peer.warm),
                     "OMPL RRT-Connect, FCL on fcl::OcTree",
                     "CPU ms a query",
                     true,
                     options.runs,
                     {}};
  result.detail = {{"problems", tasks.size()},
                   {"seeds", seeds},
                   {"limit_s", limit},
                   {"peer_valid_limit_s", valid_peer_limit},
                   {"rrtconnect", reported(trees)},
                   {"auto", reported(chosen)},
                   {"first", reported(first)},
                   {"peer_default", reported(peer)},
                   {"peer_valid", reported(valid_peer)},
                   {"peer_valid_resolution", valid_resolution}};
  const std::string finer = "peer at " + figure(valid_resolution) + " of the extent";
  const std::vector<std::string> head{"CPU ms a query", "median",         "at 95 %",
                                      "solved",         "of these valid", "of rrtconnect's median"};
  result.tables = {{"In a map that was planned in before:",
                    head,
                    {row_of("`rrtconnect`", trees, trees.warm, trees.warm),
                     row_of("`auto`", chosen, chosen.warm, trees.warm),
                     row_of("peer at OMPL's default", peer, peer.warm, trees.warm),
                     row_of(finer, valid_peer, valid_peer.warm, trees.warm)}},
                   {"Right after a depth frame changed that map, all that is derived from it included:",
                    head,
                    {row_of("`rrtconnect`", trees, trees.changed, trees.changed),
                     row_of("`auto`", chosen, chosen.changed, trees.changed),
                     row_of("peer at OMPL's default", peer, peer.changed, trees.changed),
                     row_of(finer, valid_peer, valid_peer.changed, trees.changed)},
                    "Solved and valid are those of the map before."},
                   {"The first query of a map that is in memory, with nothing derived from it, ours, CPU ms:",
                    {"voxels", "queries", "first answer of `is_free`", "`rrtconnect`, median", "at 95 %",
                     "`auto`, median", "at 95 %"},
                    rows_of(first)}};
  result.compared = count_text(static_cast<double>(tasks.size())) +
                    " problems of the suites `cells` and `guided`, with " + std::to_string(seeds) +
                    " seeds each: paths that are proved on every edge and "
                    "shortened, against RRT-Connect of OMPL with its simplification on FCL's shapes and an "
                    "`fcl::OcTree`, at its default resolution and at one whose paths are mostly valid by "
                    "`clearway check`. A query that does not end in " +
                    figure(limit) + " s counts as that; the peer whose paths are valid has " +
                    figure(valid_peer_limit) + " s, and one seed, for which its ratio is.";
  return result;
}

}  // namespace clearway::bench
