// One control step (kinematics, constraints, quadratic program) of a 6-joint arm in a map of more than a
// million voxels, against the same step with FCL's distances of each body to an fcl::OcTree of the same map.
// In `detail`: where the time goes, three arms together, and our distance between bodies against FCL's.

#include <fcl/geometry/octree/octree.h>
#include <octomap/OcTree.h>

#include <ctime>
#include <memory>
#include <numbers>

#include "apps/bench/bench.hpp"
#include "apps/bench/peers/fcl_bodies.hpp"
#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/constraint/control_step.hpp"
#include "planning/constraint/obstacle_constraints.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/blocked_octree.hpp"

namespace clearway::bench {
namespace {

constexpr double influence = 0.08, security = 0.01;
constexpr int starts = 40, steps_each = 50;

DamperOptions damper(const Robot& robot) {
  return {0.01, influence, security, 0.5 * (influence - security),
          Eigen::VectorXd::Ones(static_cast<Eigen::Index>(robot.dof()))};
}

/// This thread's CPU time, us. A call takes some 0.3 us, which are taken off (`clock_us`).
double now_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double clock_us() {
  std::vector<double> took;
  for (int i = 0; i < 2000; ++i) {
    const double begin = now_us();
    took.push_back(now_us() - begin);
  }
  return median(took);
}

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

  nlohmann::ordered_json told() const {
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
nlohmann::ordered_json told_of_all(const std::vector<Times>& runs) {
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
  nlohmann::ordered_json told = all.told();
  told["p99_in_motion_us"] = quantile(all.in_motion, 0.99);
  told["p99_of_medians_us"] = quantile(medians, 0.99);
  return told;
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

/// Three arms that stand 0.9 m apart, each with constraints against the map, itself and the bodies of both
/// others.
nlohmann::ordered_json three_arms(const Snapshot& map, const Robot& robot) {
  struct Arm {
    std::unique_ptr<ConfigurationSpace> space;
    std::unique_ptr<ControlStep> control;
    std::unique_ptr<ObstacleConstraints> near;
    std::vector<PlacedShape> bodies;
    std::vector<ObstacleConstraint> constraints;
    Configuration q, goal;
  };
  std::vector<Arm> arms(3);
  Dice dice(9);
  for (std::size_t i = 0; i < arms.size(); ++i) {
    Robot placed = robot;
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    placed.map_from_base.translation() = 0.52 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    arms[i].space = std::make_unique<ConfigurationSpace>(placed, map, Policies{.critical_by_default = false});
    DamperOptions options = damper(robot);
    options.xi /= 2.0;
    arms[i].control = std::make_unique<ControlStep>(*arms[i].space, options);
    arms[i].near = std::make_unique<ObstacleConstraints>(arms[i].space->robot());
  }
  std::vector<double> times;
  double pairs = 0.0, constraints = 0.0;
  const double clock = clock_us();
  for (int start = 0; start < 60; ++start) {
    for (Arm& arm : arms) {
      do arm.q = dice.configuration(robot);
      while (!arm.space->is_free(arm.q));
      arm.goal = dice.configuration(robot);
      arm.bodies = placed_bodies(arm.space->robot(), forward_kinematics(arm.space->robot(), arm.q));
    }
    for (int i = 0; i < 20; ++i) {
      const double begin = now_us();
      for (Arm& arm : arms) {
        arm.control->look(arm.q);
        move_bodies(arm.space->robot(), arm.control->constraints().kinematics().map_from_link(),
                    Eigen::VectorXd::Zero(6), arm.bodies);
      }
      for (Arm& arm : arms) {
        arm.constraints.clear();
        for (const Arm& other : arms) {
          if (&other != &arm)
            arm.near->append(arm.control->constraints().kinematics().map_from_link(), other.bodies, influence,
                             arm.constraints);
        }
        for (const ObstacleConstraint& constraint : arm.constraints)
          arm.control->add({constraint.gradient.data(), 6},
                           damper_bound(arm.control->options(), constraint.distance));
        pairs += static_cast<double>(arm.constraints.size());
        constraints += static_cast<double>(arm.control->constraints().constraints().size());
        arm.q += arm.control->solve(step_to_goal(arm.control->options(), arm.q, arm.goal));
      }
      times.push_back(now_us() - begin - clock);
    }
  }
  const auto count = static_cast<double>(times.size());
  return {{"median_us", median(times)},
          {"p99_us", quantile(times, 0.99)},
          {"rows_between_arms", pairs / count},
          {"other_rows", constraints / count}};
}

/// How much farther than the nearest voxel of all the nearest constraint of a body is, by exact shapes.
nlohmann::ordered_json against_exact(const ConfigurationSpace& space) {
  const Robot& robot = space.robot();
  ControlConstraints all(space, influence, 0.5 * (influence + security));
  Dice dice(7);
  int near = 0, farther = 0, farther_by_1_mm = 0;
  double worst = 0.0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Configuration q = dice.configuration(robot);
    std::vector<double> ours(robot.bodies.size(), influence), exact = ours;
    all.look(q);
    const auto note = [](std::vector<double>& least, int body, double distance) {
      double& known = least[static_cast<std::size_t>(body)];
      known = std::min(known, distance);
    };
    for (const ControlConstraint& constraint : all.constraints())
      note(ours, constraint.body, constraint.distance);
    for (const ProximityConstraint& constraint : space.proximity_constraints(q, influence))
      note(exact, constraint.body, constraint.distance);
    for (std::size_t body = 0; body < ours.size(); ++body) {
      if (exact[body] >= influence) continue;
      const double by = ours[body] - exact[body];
      ++near;
      farther += by > 1e-5;
      farther_by_1_mm += by > 1e-3;
      worst = std::max(worst, by);
    }
  }
  return {
      {"bodies", near}, {"farther", farther}, {"farther_by_1_mm", farther_by_1_mm}, {"farther_by_m", worst}};
}

/// Our distance between bodies against the smaller of FCL's two solvers (either alone can be too large).
nlohmann::ordered_json against_fcl(const Robot& robot) {
  const FclBodies bodies(robot);
  Dice dice(4);
  double ours = 0.0, theirs = 0.0, above = 0.0, below = 0.0;
  int compared = 0, fcl_above = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const LinkPoses one = forward_kinematics(robot, dice.configuration(robot));
    Robot other = robot;
    other.map_from_base.translation() = Eigen::Vector3d(0.7, 0.2, 0.0);
    const LinkPoses two = forward_kinematics(other, dice.configuration(robot));
    for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
      const std::size_t b = (a + static_cast<std::size_t>(trial)) % robot.bodies.size();
      const Eigen::Isometry3d pose_a = bodies.pose(robot, a, one), pose_b = bodies.pose(robot, b, two);
      DistanceBounds bounds;
      const double begin = now_us();
      bounds = distance(robot.bodies[a].shape, pose_a, robot.bodies[b].shape, pose_b);
      const double middle = now_us();
      const double first = fcl_distance(*bodies.shapes[a], pose_a, *bodies.shapes[b], pose_b).distance;
      const double end = now_us();
      if (first <= 0.0 || bounds.lower <= 0.0) continue;
      const double second =
          fcl_distance(*bodies.shapes[a], pose_a, *bodies.shapes[b], pose_b, fcl::GST_INDEP).distance;
      const double least = std::min(first, second);
      ++compared;
      ours += middle - begin;
      theirs += end - middle;
      above = std::max(above, bounds.lower - least);
      below = std::max(below, least - bounds.lower);
      fcl_above += first > bounds.upper + 1e-3;
    }
  }
  const double clock = clock_us() * compared;
  return {{"pairs", compared},
          {"ours_us", (ours - clock) / compared},
          {"fcl_us", (theirs - clock) / compared},
          {"ours_above_fcl_m", above},
          {"ours_below_fcl_m", below},
          {"fcl_too_large_by_1_mm", fcl_above}};
}

}  // namespace

BenchResult bench_control(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const Robot robot = load_robot("puma560");
  const Snapshot map =
      ArmWorld{.resolution = resolution, .half = 1.2, .spheres = 60, .gap = resolution}.snapshot(robot);
  const ConfigurationSpace space(robot, map, {.critical_by_default = false});
  const std::vector<Task> tasks = tasks_near(space);
  const DamperOptions damping = damper(robot);
  FclStep fcl(space, damper(robot));
  std::vector<Times> runs;
  const Pair pair = interleave(
      options.runs,
      [&] {
        runs.push_back(run_ours(space, damping, tasks, steps_each));
        return median(runs.back().whole);
      },
      [&] {
        std::vector<double> took;
        for (const Task& task : tasks)
          took.push_back(fcl.us(task.start, step_to_goal(damping, task.start, task.goal)));
        return median(took);
      });
  nlohmann::ordered_json detail = told_of_all(runs);
  Dice dice(6);
  std::vector<Task> jumps;
  while (jumps.size() < 1000) {
    const Configuration q = dice.configuration(robot);
    const double clearance = space.clearance(q);
    if (clearance > security && clearance < influence) jumps.push_back({q, q});
  }
  detail["from_place_to_place"] = run_ours(space, damping, jumps, 1).told();
  detail["balls"] = ControlConstraints(space, damping).spheres();
  detail["known_voxels"] = map.counts().seen_free + map.counts().occupied;
  detail["blocked_voxels"] = space.blocked_space(2)->blocked_count();
  detail["resolution"] = resolution;
  detail["nearest_rows_against_exact"] = against_exact(space);
  detail["three_arms"] = three_arms(map, robot);
  detail["distance_against_fcl"] = against_fcl(robot);
  return {pair.ours,    pair.peer, "the same step with fcl::distance to fcl::OcTree", "CPU us per step", true,
          options.runs, detail};
}

}  // namespace clearway::bench
