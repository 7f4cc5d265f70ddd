// One control step (kinematics, constraints, quadratic program) of a 6-joint arm in a map of more than a
// million voxels, against the same step with FCL's distances of each body to an fcl::OcTree of the same map.
// In `detail`: where the time goes, three arms together, and our distance between bodies against FCL's.

#include <fcl/geometry/octree/octree.h>
#include <octomap/OcTree.h>

#include "apps/bench/control_parts.hpp"
#include "apps/bench/peers/fcl_bodies.hpp"
#include "apps/bench/worlds/arm_damper.hpp"
#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/constraint/control_step.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/blocked_octree.hpp"

namespace clearway::bench {
namespace {

constexpr int starts = 40, steps_each = 50;

/// Where the arm is near something, but not too near: starts of motions, and where each wants to go.
struct Task {
  Configuration start, goal;
};

std::vector<Task> tasks_near(const ConfigurationSpace& space) {
  Dice dice(1);
  std::vector<Task> tasks;
  while (tasks.size() < starts) {
    const Configuration q = dice.configuration(space.robot());
    const double clearance = space.clearance(q);
    if (clearance > security && clearance < influence)
      tasks.push_back({q, dice.configuration(space.robot())});
  }
  return tasks;
}

/// What each step took, us, and what it saw.
struct Times {
  std::vector<double> whole, kinematics, constraints, program;
  std::vector<double> in_motion;  ///< of whole: without the first step of each motion, to which the arm jumps
  double constraint_count = 0.0, active = 0.0;

  nlohmann::ordered_json reported() const {
    const double all = median(kinematics) + median(constraints) + median(program);
    return {{"median_us", median(whole)},
            {"p95_us", quantile(whole, 0.95)},
            {"p99_us", quantile(whole, 0.99)},
            {"rows", constraint_count / static_cast<double>(whole.size())},
            {"active_rows", active / static_cast<double>(whole.size())},
            {"share_kinematics", median(kinematics) / all},
            {"share_rows", median(constraints) / all},
            {"share_program", median(program) / all}};
  }
};

/// The steps of all runs together, and each step's median over the runs: what it costs itself, without what
/// the machine does meanwhile.
nlohmann::ordered_json summary_of(const std::vector<Times>& runs) {
  Times all;
  std::vector<double> medians;
  for (const Times& run : runs) {
    for (const auto part :
         {&Times::whole, &Times::in_motion, &Times::kinematics, &Times::constraints, &Times::program})
      (all.*part).insert((all.*part).end(), (run.*part).begin(), (run.*part).end());
    all.constraint_count += run.constraint_count;
    all.active += run.active;
  }
  for (std::size_t step = 0; step < runs.front().whole.size(); ++step) {
    std::vector<double> took;
    for (const Times& run : runs) took.push_back(run.whole[step]);
    medians.push_back(median(took));
  }
  nlohmann::ordered_json reported = all.reported();
  reported["p99_in_motion_us"] = quantile(all.in_motion, 0.99);
  reported["p99_of_medians_us"] = quantile(medians, 0.99);
  return reported;
}

/// Each step is taken. `step(q, wanted, is_first)` does one and notes what it took.
template <class Step>
void walk(const DamperOptions& options, const std::vector<Task>& tasks, int steps, const Step& step) {
  for (const Task& task : tasks) {
    Configuration q = task.start;
    for (int i = 0; i < steps; ++i) q += step(q, step_to_goal(options, q, task.goal), i == 0);
  }
}

/// The loop, with a new object that remembers nothing, twice: for the whole, and for its parts, as each look
/// at the clock is a call of the kernel's that slows down what follows it.
Times run_ours(const ConfigurationSpace& space, const DamperOptions& options, const std::vector<Task>& tasks,
               int steps) {
  Times times;
  const double clock = clock_us();
  ControlStep control(space, options);
  walk(options, tasks, steps, [&](const Configuration& q, const Eigen::VectorXd& wanted, bool is_first) {
    const double begin = now_us();
    control.look(q);
    const Eigen::VectorXd& step = control.solve(wanted);
    times.whole.push_back(std::max(0.0, now_us() - begin - clock));
    if (!is_first) times.in_motion.push_back(times.whole.back());
    times.constraint_count += static_cast<double>(control.constraints().constraints().size());
    for (const double multiplier : control.solver().multipliers()) times.active += multiplier > 0.0;
    return step;
  });
  ControlStep parts(space, options);
  walk(options, tasks, steps, [&](const Configuration& q, const Eigen::VectorXd& wanted, bool) {
    const double begin = now_us();
    parts.constraints().place(q);
    const double placed = now_us();
    parts.constraints().find_constraints();
    const double found = now_us();
    parts.load(q);
    const Eigen::VectorXd& step = parts.solve(wanted);
    times.kinematics.push_back(std::max(0.0, placed - begin - clock));
    times.constraints.push_back(std::max(0.0, found - placed - clock));
    times.program.push_back(std::max(0.0, now_us() - found - clock));
    return step;
  });
  return times;
}

/// The same step with FCL: unsigned, the tree first (the other order swaps the witness points).
class FclStep {
 public:
  FclStep(const ConfigurationSpace& space, const DamperOptions& options)
      : space_(space),
        options_(options),
        bodies_(space.robot()),
        pairs_(self_collision_pairs(space.robot())),
        tree_(blocked_octree(space.map(), {Policy::not_occupied})) {}

  double us(const Configuration& q, const Eigen::VectorXd& wanted) {
    const double begin = now_us();
    const Robot& robot = space_.robot();
    const LinkPoses poses = forward_kinematics(robot, q);
    solver_.begin(static_cast<int>(robot.dof()));
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      if (space_.blocked_space(static_cast<int>(i)) == nullptr) continue;
      const FclDistance found = fcl_distance(tree_, Eigen::Isometry3d::Identity(), *bodies_.shapes[i],
                                             bodies_.pose(robot, i, poses));
      add(robot, poses, robot.bodies[i].link, found.b, found.a - found.b, found.distance);
    }
    for (const BodyPair& pair : pairs_) {
      const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
      const FclDistance found = fcl_distance(*bodies_.shapes[a], bodies_.pose(robot, a, poses),
                                             *bodies_.shapes[b], bodies_.pose(robot, b, poses));
      add(robot, poses, robot.bodies[a].link, found.a, found.b - found.a, found.distance);
    }
    const Eigen::VectorXd most = Eigen::VectorXd::Constant(wanted.size(), options_.max_step), least = -most;
    const auto numbers = [](const Eigen::VectorXd& v) {
      return std::span(v.data(), static_cast<std::size_t>(v.size()));
    };
    solver_.set_limits(numbers(least), numbers(most));
    solver_.set_target(numbers(wanted));
    solver_.solve_relaxed();
    return now_us() - begin;
  }

 private:
  void add(const Robot& robot, const LinkPoses& poses, int link, const Eigen::Vector3d& point,
           const Eigen::Vector3d& way, double distance) {
    if (distance >= influence || !(distance > 0.0)) return;
    const Eigen::VectorXd normal =
        jacobian(robot, poses, link, point).topRows<3>().transpose() * way.stableNormalized();
    solver_.add_constraint({normal.data(), static_cast<std::size_t>(normal.size())},
                           damper_bound(options_, distance));
  }

  const ConfigurationSpace& space_;
  DamperOptions options_;
  FclBodies bodies_;
  std::vector<BodyPair> pairs_;
  fcl::OcTreed tree_;
  QuadraticSolver solver_;
};

/// From one random place to another: nothing is remembered from the step before.
std::vector<Task> jumps_near(const ConfigurationSpace& space) {
  Dice dice(6);
  std::vector<Task> jumps;
  while (jumps.size() < 1000) {
    const Configuration q = dice.configuration(space.robot());
    const double clearance = space.clearance(q);
    if (clearance > security && clearance < influence) jumps.push_back({q, q});
  }
  return jumps;
}

std::vector<std::string> us_row(const std::string& name, const nlohmann::ordered_json& reported) {
  const auto cell = [&](const char* key) {
    return reported.contains(key) ? figure(reported[key].get<double>()) : std::string("–");
  };
  return {name, cell("median_us"), cell("p95_us"), cell("p99_us")};
}

std::vector<Table> control_tables(const nlohmann::ordered_json& detail, const Pair& pair) {
  Table times{"", {"CPU us per step", "median", "p95", "p99"}, {}};
  times.rows = {us_row("ours, along motions", detail),
                us_row("ours, from one random place to another", detail["from_place_to_place"]),
                us_row("ours, three arms with all their pairs", detail["three_arms"]),
                {"FCL, the motions' first steps", figure(pair.peer), "–", "–"},
                {"ours, the same first steps", figure(pair.ours), "–", "–"},
                {"ratio", figure(pair.ratio()), "–", "–"}};
  const auto& exact = detail["nearest_rows_against_exact"];
  const auto& fcl = detail["distance_against_fcl"];
  const auto number = [](const nlohmann::ordered_json& value) { return figure(value.get<double>()); };
  Table parts{"", {"part", "figure"}, {}};
  parts.rows = {
      {"rows per step", number(detail["rows"])},
      {"share of rows / kinematics / program", percent(detail["share_rows"].get<double>()) + " / " +
                                                   percent(detail["share_kinematics"].get<double>()) + " / " +
                                                   percent(detail["share_program"].get<double>())},
      {"bodies with a nearer cube than their rows report",
       count_text(exact["farther"].get<double>()) + " of " + count_text(exact["bodies"].get<double>())},
      {"by more than 1 mm; at most", count_text(exact["farther_by_1_mm"].get<double>()) + "; " +
                                         figure(1e3 * exact["farther_by_m"].get<double>()) + " mm"},
      {"`distance` of two bodies, ours / FCL",
       number(fcl["ours_us"]) + " / " + number(fcl["fcl_us"]) + " us"}};
  return {times, parts};
}

}  // namespace

BenchResult bench_control(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const Robot robot = load_robot("puma560");
  const Snapshot map =
      ArmWorld{.resolution = resolution, .half = 1.2, .spheres = 60, .gap = resolution}.snapshot(robot);
  const ConfigurationSpace space(robot, map, {.critical_by_default = false});
  const std::vector<Task> tasks = tasks_near(space);
  const DamperOptions damping = arm_damper(robot, step_limit);
  FclStep fcl(space, damping);
  std::vector<Times> runs;
  const Pair pair = interleave(
      options,
      [&] {
        runs.push_back(run_ours(space, damping, tasks, steps_each));
        return median(run_ours(space, damping, tasks, 1).whole);
      },
      [&] {
        std::vector<double> took;
        for (const Task& task : tasks)
          took.push_back(fcl.us(task.start, step_to_goal(damping, task.start, task.goal)));
        return median(took);
      });
  options.say("parts");
  nlohmann::ordered_json detail = summary_of(runs);
  const VoxelCounts counts = map.counts();
  const std::size_t known = counts.seen_free + counts.occupied;
  detail["from_place_to_place"] = run_ours(space, damping, jumps_near(space), 1).reported();
  detail["balls"] = ControlConstraints(space, damping).spheres();
  detail["known_voxels"] = known;
  detail["blocked_voxels"] = space.blocked_space(2)->blocked_count();
  detail["resolution"] = resolution;
  detail["nearest_rows_against_exact"] = against_exact(space);
  detail["three_arms"] = three_arms(map, robot);
  detail["distance_against_fcl"] = against_fcl(robot);
  BenchResult result{
      pair.ours,    pair.peer, "the same step with fcl::distance to fcl::OcTree", "CPU us per step", true,
      options.runs, detail};
  result.compared =
      "Kinematics, rows and quadratic program of a PUMA 560 near obstacles in a map of " +
      figure(1e-6 * static_cast<double>(known)) + " million known voxels at " + length_text(resolution) +
      ", d_i = 8 cm: `ControlStep` against the same step with `fcl::distance` of each body to an "
      "`fcl::OcTree` of the map. The ratio is of the first steps of 40 motions, with nothing remembered; "
      "FCL's distances are exact, ours are rows of balls that cover the bodies.";
  result.tables = control_tables(detail, pair);
  return result;
}

}  // namespace clearway::bench
