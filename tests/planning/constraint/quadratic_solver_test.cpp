#include "planning/constraint/quadratic_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "apps/bench/worlds/random_programs.hpp"

namespace clearway {
namespace quadratic_solver_test {

using bench::ProgramDice;
using bench::ProgramKind;

/// `clearway_bench qp` judges a million.
TEST(QuadraticSolver, SolvesOrProvesInfeasibleProgramsOfEveryKind) {
  double absolute = 0.0;
  for (std::size_t kind = 0; kind < bench::program_kinds.size(); ++kind) {
    ProgramDice dice(100 + kind);
    int feasible = 0;
    for (int trial = 0; trial < 3000; ++trial) {
      const QuadraticProgram p =
          bench::random_program(dice, static_cast<ProgramKind>(kind), trial % 20 == 0 ? 200 : 40);
      const QuadraticSolution s = solve(p);
      const bench::Judgement judgement = bench::judge(p, s);
      ASSERT_TRUE(s.feasible || static_cast<ProgramKind>(kind) != ProgramKind::vertex) << trial;
      ASSERT_TRUE(judgement.is_number) << bench::program_kinds[kind] << " " << trial;
      ASSERT_LE(judgement.relative, 1e-9) << bench::program_kinds[kind] << " " << trial;
      if (s.feasible && static_cast<ProgramKind>(kind) != ProgramKind::scales)
        absolute = std::max(absolute, judgement.absolute);
      feasible += s.feasible;
    }
    EXPECT_GT(feasible, 300) << bench::program_kinds[kind];
  }
  EXPECT_LE(absolute, 1e-9);
}

/// Dykstra's alternating projections: slow, and knows nothing of active sets.
Eigen::VectorXd by_projections(const QuadraticProgram& p, int rounds) {
  Eigen::VectorXd x = p.target;
  Eigen::MatrixXd off = Eigen::MatrixXd::Zero(x.size(), p.matrix.rows() + 1);
  for (int round = 0; round < rounds; ++round) {
    for (Eigen::Index i = 0; i <= p.matrix.rows(); ++i) {
      const Eigen::VectorXd from = x + off.col(i);
      if (i == p.matrix.rows()) {
        x = from.cwiseMax(p.lower).cwiseMin(p.upper);
      } else {
        const Eigen::VectorXd a = p.matrix.row(i).transpose();
        x = from - a * (std::max(0.0, a.dot(from) - p.bounds[i]) / a.squaredNorm());
      }
      off.col(i) = from - x;
    }
  }
  return x;
}

TEST(QuadraticSolver, AgreesWithAlternatingProjections) {
  ProgramDice dice(4);
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    QuadraticProgram p = bench::random_program(dice, ProgramKind::plain, 15);
    if (p.matrix.rows() == 0) continue;
    p.lower = Eigen::VectorXd::Constant(p.target.size(), -0.5);
    p.upper = -p.lower;
    const QuadraticSolution s = solve(p);
    if (!s.feasible) continue;
    ++compared;
    EXPECT_NEAR((s.x - by_projections(p, 20000)).norm(), 0.0, 1e-4) << trial;
  }
  EXPECT_GT(compared, 30);
}

TEST(QuadraticSolver, AnObjectThatSawOtherProblemsGivesTheSameBits) {
  ProgramDice dice(6);
  QuadraticSolver used;
  const auto load = [](QuadraticSolver& solver, const QuadraticProgram& p) {
    solver.begin(static_cast<int>(p.target.size()));
    solver.set_target({p.target.data(), static_cast<std::size_t>(p.target.size())});
    for (Eigen::Index i = 0; i < p.matrix.rows(); ++i) {
      const Eigen::VectorXd normal = p.matrix.row(i).transpose();
      solver.add_constraint({normal.data(), static_cast<std::size_t>(normal.size())}, p.bounds[i]);
    }
  };
  for (int trial = 0; trial < 2000; ++trial) {
    const QuadraticProgram p = bench::random_program(dice, static_cast<ProgramKind>(trial % 7), 40);
    QuadraticSolver fresh;
    load(used, p);
    load(fresh, p);
    ASSERT_EQ(used.solve_relaxed(), fresh.solve_relaxed());
    ASSERT_TRUE(std::equal(used.x().begin(), used.x().end(), fresh.x().begin()));
    ASSERT_TRUE(
        std::equal(used.multipliers().begin(), used.multipliers().end(), fresh.multipliers().begin()));
  }
}

void add_constraints(QuadraticSolver& solver, const QuadraticProgram& p, Eigen::Index first,
                     Eigen::Index last) {
  for (Eigen::Index i = first; i < last; ++i) {
    const Eigen::VectorXd normal = p.matrix.row(i).transpose();
    solver.add_constraint({normal.data(), static_cast<std::size_t>(normal.size())}, p.bounds[i]);
  }
}

TEST(QuadraticSolver, RowsAddedAfterASolveCountAsIfGivenAtOnce) {
  ProgramDice dice(8);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Index n = 1 + trial % 7, first = 1 + dice.below(9), all = first + 1 + dice.below(6);
    QuadraticProgram p;
    p.target = dice.vector(n, 1.0);
    p.matrix.resize(all, n);
    for (Eigen::Index i = 0; i < all; ++i) p.matrix.row(i) = dice.vector(n, 2.0).transpose();
    p.bounds = dice.vector(all, 0.1).array() + 0.2;
    QuadraticSolver solver, fresh;
    for (QuadraticSolver* each : {&solver, &fresh}) {
      each->begin(static_cast<int>(n));
      each->set_target({p.target.data(), static_cast<std::size_t>(n)});
    }
    add_constraints(solver, p, 0, first);
    ASSERT_TRUE(solver.solve());
    add_constraints(solver, p, first, all);
    add_constraints(fresh, p, 0, all);
    ASSERT_TRUE(solver.solve() && fresh.solve()) << trial;
    for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j)
      ASSERT_NEAR(solver.x()[j], fresh.x()[j], 1e-12) << trial << " n " << n << " after " << first;
  }
}

TEST(QuadraticSolver, DemandsThatGaveWayAreWholeAgainAtTheNextSolve) {
  QuadraticSolver solver;
  const double right[] = {1.0}, left[] = {-1.0};
  solver.begin(1);
  solver.add_constraint(right, -0.2);
  solver.add_constraint(left, -0.1);
  EXPECT_TRUE(solver.solve_relaxed());
  EXPECT_EQ(solver.smallest_share(), 0.0);
  EXPECT_FALSE(solver.solve());
  EXPECT_EQ(solver.smallest_share(), 1.0);
}

TEST(QuadraticSolver, AHundredContradictionsAreEachEndedByTheirOwnShare) {
  constexpr int pairs = 100;
  QuadraticSolver solver;
  solver.begin(pairs);
  for (int j = 0; j < pairs; ++j) {  // x_j <= -0.2 and x_j >= -0.1
    Eigen::VectorXd normal = Eigen::VectorXd::Unit(pairs, j);
    solver.add_constraint({normal.data(), pairs}, -0.2);
    normal = -normal;
    solver.add_constraint({normal.data(), pairs}, 0.1);
  }
  ASSERT_TRUE(solver.solve_relaxed());
  for (std::size_t j = 0; j < pairs; ++j) EXPECT_NEAR(solver.shares()[2 * j], 0.5, 1e-12);
}

TEST(QuadraticSolver, NearlyParallelDemandsThatMeetFarOutsideTheLimitsContradictEachOther) {
  for (double tilt = 1e-12; tilt < 0.2; tilt *= 3.0) {
    QuadraticSolver solver;
    solver.begin(3);
    const std::array<double, 3> upper{0.01, 0.01, 0.01}, lower{-0.01, -0.01, -0.01},
        target{0.005, 0.0, 0.001};
    solver.set_limits(lower, upper);
    solver.set_target(target);
    solver.add_constraint(std::array{1.0, 0.0, 0.0}, -0.004);
    solver.add_constraint(std::array{-1.0, tilt, 0.0}, -0.004);
    EXPECT_FALSE(solver.solve()) << tilt;
    ASSERT_TRUE(solver.solve_relaxed()) << tilt;
    for (const double x : solver.x()) EXPECT_LE(std::abs(x), 0.01 + 1e-7) << tilt;
    EXPECT_NEAR(solver.smallest_share(), tilt * 0.01 / 0.008, 1e-9) << tilt;
  }
}

TEST(QuadraticSolver, NeverCallsSolvedWhatRoundingLost) {
  // Constraints that are parallel but for the last digits: points where they meet lie as far out as rounding
  // likes.
  ProgramDice dice(1);
  int feasible = 0, proved = 0, given_up = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    QuadraticProgram p = bench::random_program(dice, ProgramKind::squeezed, 40);
    for (double& number : p.matrix.reshaped()) {
      const int twist = dice.below(6);
      if (twist == 0) number = 0.0;
      if (twist == 1) number = 1e-13 * dice.between(-1.0, 1.0);
    }
    const QuadraticSolution s = solve(p);
    ASSERT_TRUE(s.x.allFinite() && s.multipliers.allFinite()) << trial;
    const bool is_decided = s.feasible || !s.multipliers.isZero(0.0);
    if (is_decided) {
      EXPECT_LE(bench::judge(p, s).relative, 1e-9) << trial;
    }
    ++(s.feasible ? feasible : is_decided ? proved : given_up);
  }
  EXPECT_GT(feasible, 3000);
  EXPECT_GT(proved, 3000);
  EXPECT_LT(given_up, 10);
}

TEST(QuadraticSolver, RowsOutOfAllReachAreNoConstraintOrAContradiction) {
  QuadraticSolver solver;
  const double tiny[] = {1e-140, 0.0}, one[] = {1.0, 0.0};
  solver.begin(2);
  solver.set_target(one);
  solver.add_constraint(tiny, 1.0);
  EXPECT_TRUE(solver.solve());
  EXPECT_EQ(solver.x()[0], 1.0);
  solver.add_constraint(tiny, -1.0);
  EXPECT_FALSE(solver.solve());
  EXPECT_EQ(solver.conflicting(), 1);
  EXPECT_TRUE(solver.solve_relaxed());
  EXPECT_EQ(solver.smallest_share(), 0.0);
}

}  // namespace quadratic_solver_test
}  // namespace clearway
