#include "planning/constraint/control_step.hpp"

#include <gtest/gtest.h>

#include "apps/bench/worlds/random_programs.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace control_step_test {

constexpr double edge = 0.02;

/// A wall that leans: its voxels are stairs of uneven width.
Snapshot slanted_wall(double slope) {
  FreeSpaceMap map({.resolution = edge});
  for (double y = -0.9; y < 0.9; y += 0.25 * edge) {
    const Eigen::Vector3d on(0.55 + slope * y, y, 0.01);
    occupy(map, ((on / edge).array().floor() + 0.5) * edge);
  }
  return map.snapshot();
}

DamperOptions damper(std::size_t joints) {
  return {0.005, 0.12, 0.02, 0.05, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(joints))};
}

/// How the steps of a motion change from one to the next.
struct Smoothness {
  double roughest = 0.0;  ///< largest second difference of any joint over the longest step
  double total = 0.0;     ///< mean length of the second difference over that of the step
  int sign_flips = 0;     ///< steps across the wall (x) whose sign changes thrice running
  double least = 1.0;     ///< separation
};

/// Slides the disc along the wall, drawn against it, with constraints of the caller's choice.
template <class Step>
Smoothness slide(const Step& step_at, double slope) {
  Smoothness result;
  Eigen::Vector2d q(0.55 - slope * 0.6 - 0.4, -0.6);
  const Eigen::Vector2d along = Eigen::Vector2d(slope, 1.0).normalized();
  const Eigen::Vector2d wanted = 0.003 * (along + Eigen::Vector2d(along.y(), -along.x())).normalized();
  Eigen::Vector2d last = Eigen::Vector2d::Zero(), before_last = last;
  double changes = 0.0, way = 0.0;
  for (int i = 0; i < 700 && q.y() < 0.5; ++i) {
    const Eigen::Vector2d step = step_at(q, wanted, result.least);
    q += step;
    if (i > 60) {  // once it is at the wall
      const Eigen::Vector2d across(along.y(), -along.x());
      result.roughest = std::max(result.roughest, (step - last).cwiseAbs().maxCoeff() / wanted.norm());
      changes += (step - last).norm();
      way += step.norm();
      const double now = across.dot(step), then = across.dot(last), once = across.dot(before_last);
      result.sign_flips += now * then < -1e-10 && then * once < -1e-10;
    }
    before_last = last;
    last = step;
  }
  EXPECT_GT(q.y(), 0.2);  // it came along
  result.total = changes / way;
  return result;
}

TEST(ControlStep, SlidesSmoothlyAlongASlantedWallOfVoxelsWhereTheNearestCubeAloneChatters) {
  const Robot robot = load_robot("point");
  double roughness = 0.0, naive_roughness = 0.0, naive_roughest = 0.0;
  int naive_flips = 0;
  for (const double slope : {0.13, 0.31, 0.57, 0.83}) {
    const ConfigurationSpace space(robot, slanted_wall(slope), {.critical_by_default = false},
                                   {.max_distance = 0.5});
    const DamperOptions options = damper(2);
    ControlStep control(space, options);
    const Smoothness ours = slide(
        [&](const Eigen::Vector2d& q, const Eigen::Vector2d& wanted, double& least) -> Eigen::Vector2d {
          control.look(q);
          least = std::min(least, control.separation());
          return control.solve(wanted);
        },
        slope);
    const Smoothness naive = slide(
        [&](const Eigen::Vector2d& q, const Eigen::Vector2d& wanted, double& least) -> Eigen::Vector2d {
          StepConstraints all = constraints_at(space, q, options);
          Eigen::Index nearest = 0;
          if (all.bounds.size() == 0) return wanted;
          all.bounds.minCoeff(&nearest);
          least = std::min(least, all.separation);
          StepConstraints one = all;
          one.matrix = all.matrix.row(nearest);
          one.bounds = all.bounds.segment(nearest, 1);
          return local_step(one, wanted, options).step;
        },
        slope);
    EXPECT_EQ(ours.sign_flips, 0) << slope;
    EXPECT_GT(ours.least, options.security_distance - 1e-4) << slope;
    EXPECT_LT(ours.roughest, 0.45) << slope;
    roughness += ours.total;
    naive_roughness += naive.total;
    naive_roughest = std::max(naive_roughest, naive.roughest);
    naive_flips += naive.sign_flips;
  }
  EXPECT_LT(roughness, naive_roughness);
  EXPECT_GT(naive_roughest, 0.45);
  EXPECT_GT(naive_flips, 0);
}

TEST(ControlStep, AnotherNumberOfValuesThanJointsIsRefused) {
  const ConfigurationSpace space(load_robot("point"), slanted_wall(0.1), {.critical_by_default = false});
  ControlStep step(space, damper(2));
  EXPECT_EQ(step.solve(Eigen::Vector2d(1.0, 1.0)),
            Eigen::VectorXd(Eigen::Vector2d::Zero()));  // before it looked
  EXPECT_THROW(step.look(Eigen::Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(step.look(Eigen::Vector2d(std::nan(""), 0.0)), std::invalid_argument);
  step.look(Eigen::Vector2d::Zero());
  const std::vector<double> three(3, 1.0), one(1, 1.0);
  EXPECT_THROW(step.add(three, 0.1), std::invalid_argument);
  EXPECT_THROW(step.add(one, 0.1), std::invalid_argument);
  EXPECT_THROW(step.solve(Eigen::VectorXd::Zero(1)), std::invalid_argument);
  EXPECT_EQ(step.solve(Eigen::Vector2d::Zero()).size(), 2);
  DamperOptions lost = damper(2);
  lost.weight[1] = std::nan("");
  EXPECT_THROW(ControlStep(space, lost), std::invalid_argument);
  lost.weight.setOnes(3);
  const Eigen::Vector2d here(0.0, 0.0);
  EXPECT_THROW(step_to_goal(lost, here, here), std::invalid_argument);
  EXPECT_THROW(step_to_goal(damper(2), here, Eigen::Vector3d::Zero()), std::invalid_argument);
  for (const double odd : {std::nan(""), 1e200, HUGE_VAL})
    EXPECT_THROW(step_to_goal(damper(2), here, Eigen::Vector2d(0.0, odd)), std::invalid_argument);
}

TEST(ControlStep, KeepsTheDamperOfTheNearestVoxelAndTheLimits) {
  const Robot robot = load_robot("puma560");
  Random random(8);
  VoxelScene scene;
  scene.occupied = {box_of(0.4, -0.5, 0.2, 0.5, 0.5, 0.6), box_of(-0.4, 0.3, 0.3, 0.4, 0.4, 0.8)};
  const ConfigurationSpace space(robot, scene.snapshot(), {.critical_by_default = false});
  const DamperOptions options = damper(6);
  ControlStep control(space, options);
  // Those that no step can bring to their damper, too.
  ControlConstraints all(space, options.influence_distance,
                         0.5 * (options.influence_distance + options.security_distance));
  int near = 0, moved = 0;
  std::size_t left_out = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Configuration q = random.configuration(robot);
    if (trial % 3 == 0) q[1] = robot.joints[1].upper - 0.001;
    const Eigen::VectorXd wanted =
        0.005 * Eigen::VectorXd::NullaryExpr(6, [&] { return random.between(-1.0, 1.0); });
    control.look(q);
    if (control.separation() < options.security_distance) continue;  // constraints may have to give way
    const Eigen::VectorXd step = control.solve(wanted);
    moved += step.norm() > 0.5 * wanted.norm();
    all.look(q);
    left_out += all.constraints().size() - control.constraints().constraints().size();
    for (std::size_t i = 0; i < all.constraints().size(); ++i) {
      const ControlConstraint& constraint = all.constraints()[i];
      double approach = 0.0;
      for (std::size_t j = 0; j < 6; ++j) approach += all.gradient(i)[j] * step[static_cast<Eigen::Index>(j)];
      EXPECT_LE(approach, constraint.distance - options.security_distance + 1e-9);
      if (constraint.behind > 0.0) continue;
      ++near;
      EXPECT_LE(approach, damper_bound(options, constraint.distance) + 1e-9);
    }
    for (std::size_t j = 0; j < 6; ++j) {
      EXPECT_LE(q[static_cast<Eigen::Index>(j)] + step[static_cast<Eigen::Index>(j)],
                robot.joints[j].upper + 1e-9);
    }
    EXPECT_LE(step.cwiseAbs().maxCoeff(), options.max_step + 1e-12);
  }
  EXPECT_GT(near, 300);
  EXPECT_GT(moved, 300);
  EXPECT_GT(left_out, 500U);
}

TEST(ControlStep, IsThatOfAllPairsOfBodiesThoughThoseThatNoStepCanBringNearHaveNoConstraint) {
  std::size_t left_out = 0, pairs = 0;
  int compared = 0, contradictions = 0;
  for (const char* name : {"puma560", "panda", "arm5"}) {
    const Robot robot = load_robot(name);
    Random random(12);
    const ConfigurationSpace space(robot, VoxelScene{}.snapshot(), {.critical_by_default = false});
    DamperOptions options = damper(robot.dof());
    options.max_step = 0.03;
    ControlStep control(space, options);
    ControlConstraints all(space, options.influence_distance, options.influence_distance);
    QuadraticSolver solver;
    for (int trial = 0; trial < 2000; ++trial) {
      const Configuration q = random.configuration(robot);
      const auto n = q.size();
      const Eigen::VectorXd wanted =
          Eigen::VectorXd::NullaryExpr(n, [&] { return options.max_step * random.between(-1.0, 1.0); });
      control.look(q);
      const Eigen::VectorXd step = control.solve(wanted);
      all.look(q);
      solver.begin(static_cast<int>(n));
      const auto numbers = [](const Eigen::VectorXd& vector) {
        return std::span(vector.data(), static_cast<std::size_t>(vector.size()));
      };
      Eigen::VectorXd lower(n), upper(n);
      for (Eigen::Index j = 0; j < n; ++j) {
        const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
        lower[j] = std::clamp(joint.lower - q[j], -options.max_step, 0.0);
        upper[j] = std::clamp(joint.upper - q[j], 0.0, options.max_step);
      }
      solver.set_limits(numbers(lower), numbers(upper));
      for (std::size_t i = 0; i < all.constraints().size(); ++i)
        solver.add_constraint(all.gradient(i), damper_bound(options, all.constraints()[i].distance));
      solver.set_target(numbers(wanted));
      ASSERT_TRUE(solver.solve_relaxed());
      // The smallest share is the largest possible one; which steps come of it is decided by rounding.
      EXPECT_NEAR(control.solver().smallest_share(), solver.smallest_share(), 1e-9) << name << ' ' << trial;
      ++(solver.smallest_share() < 1.0 ? contradictions : compared);
      if (solver.smallest_share() < 1.0) continue;
      const Eigen::VectorXd expected = Eigen::Map<const Eigen::VectorXd>(solver.x().data(), n);
      EXPECT_LT((step - expected).norm(), 1e-9) << name << ' ' << trial;
      pairs += all.constraints().size();
      left_out += all.constraints().size() - control.constraints().constraints().size();
    }
  }
  EXPECT_GT(left_out, 1000U);
  EXPECT_GT(pairs - left_out, 1000U);
  EXPECT_GT(compared, 5000);
  EXPECT_GT(contradictions, 500);
}

/// The program that a step solved, with what its demands kept.
QuadraticProgram relaxed_program(const ControlStep& control, const Configuration& q,
                                 const Eigen::VectorXd& wanted) {
  const DamperOptions& options = control.options();
  const std::vector<Joint>& joints = control.constraints().robot().joints;
  const auto count = static_cast<Eigen::Index>(control.constraints().constraints().size());
  QuadraticProgram program{wanted, Eigen::MatrixXd(count, q.size()), Eigen::VectorXd(count),
                           Eigen::VectorXd(q.size()), Eigen::VectorXd(q.size())};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const ControlConstraint& constraint = control.constraints().constraints()[at];
    const double alone = damper_bound(options, constraint.distance);
    const double behind = std::min(damper_bound(options, constraint.distance + constraint.behind),
                                   constraint.distance - options.security_distance);
    const double bound = constraint.behind > 0.0 ? std::max(alone, behind) : alone;
    program.matrix.row(i) =
        Eigen::Map<const Eigen::RowVectorXd>(control.constraints().gradient(at).data(), q.size());
    program.bounds[i] = bound * control.solver().shares()[at];
  }
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = joints[static_cast<std::size_t>(j)];
    program.lower[j] = std::clamp(joint.lower - q[j], -options.max_step, 0.0);
    program.upper[j] = std::clamp(joint.upper - q[j], 0.0, options.max_step);
  }
  return program;
}

TEST(ControlStep, IsTheNearestOneWithinItsLimitsWhereBodiesOverlapAndConstraintsContradictEachOther) {
  const Robot robot = load_robot("panda");
  Random random(13);
  FreeSpaceMap map({.resolution = edge});
  for (int i = 0; i < 1500; ++i) occupy(map, ((random.point(0.8) / edge).array().floor() + 0.5) * edge);
  const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false});
  const DamperOptions options = damper(7);
  ControlStep control(space, options);
  int contradictions = 0, moved = 0, refused = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Configuration q = random.configuration(robot);
    control.look(q);
    const Eigen::VectorXd wanted =
        Eigen::VectorXd::NullaryExpr(7, [&] { return options.max_step * random.between(-1.0, 1.0); });
    const Eigen::VectorXd step = control.solve(wanted);
    ASSERT_LE(step.cwiseAbs().maxCoeff(), options.max_step) << trial;
    if (control.solver().smallest_share() == 1.0) continue;
    ++contradictions;
    moved += step.norm() > 0.1 * wanted.norm();
    QuadraticSolution found;
    found.feasible = true;
    found.x = Eigen::Map<const Eigen::VectorXd>(control.solver().x().data(), 7);
    found.multipliers =
        Eigen::Map<const Eigen::VectorXd>(control.solver().multipliers().data(),
                                          static_cast<Eigen::Index>(control.solver().multipliers().size()));
    if (step.isZero(0.0)) {  // rounding left no such step
      ++refused;
      continue;
    }
    EXPECT_LT((found.x - step).norm(), 1e-6 * options.max_step) << trial;
    EXPECT_LE(bench::judge(relaxed_program(control, q, wanted), found).relative, 1e-9) << trial;
  }
  EXPECT_GT(contradictions, 500);
  EXPECT_GT(moved, contradictions / 2);
  EXPECT_LE(refused, contradictions / 100);
}

TEST(ControlStep, GivesTheSameBitsWhateverItSawBefore) {
  const Robot robot = load_robot("puma560");
  Random random(9);
  VoxelScene scene;
  scene.occupied = {box_of(0.4, -0.5, 0.2, 0.5, 0.5, 0.6)};
  const ConfigurationSpace space(robot, scene.snapshot(), {.critical_by_default = false});
  ControlStep used(space, damper(6));
  for (int trial = 0; trial < 100; ++trial) {
    const Configuration q = random.configuration(robot);
    ControlStep fresh(space, damper(6));
    used.look(q);
    fresh.look(q);
    const Eigen::VectorXd wanted = Eigen::VectorXd::Constant(6, 0.002);
    ASSERT_EQ(Eigen::VectorXd(used.solve(wanted)), Eigen::VectorXd(fresh.solve(wanted)));
  }
}

TEST(ControlStep, RefusesDampersThatCouldCrossTheSecurityDistance) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{}.snapshot(), {});
  DamperOptions options = damper(2);
  options.xi = 0.11;
  EXPECT_THROW(ControlStep(space, options), std::invalid_argument);
  options = damper(2);
  options.security_distance = options.influence_distance;
  EXPECT_THROW(ControlStep(space, options), std::invalid_argument);
  EXPECT_THROW(ControlStep(space, damper(3)), std::invalid_argument);
}

}  // namespace control_step_test
}  // namespace clearway
