#include "planning/constraint/quadratic_program.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace clearway {
namespace quadratic_program_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All constraints as rows, in the numbering of QuadraticSolution; infinite bounds kept.
std::pair<MatrixXd, VectorXd> all_constraints(const QuadraticProgram& p) {
  const Index n = p.target.size(), m = p.matrix.rows();
  MatrixXd A(m + 2 * n, n);
  VectorXd b = VectorXd::Constant(m + 2 * n, kInfinity);
  if (m) A.topRows(m) = p.matrix;
  if (m) b.head(m) = p.bounds;
  A.middleRows(m, n) = MatrixXd::Identity(n, n);
  A.bottomRows(n) = -MatrixXd::Identity(n, n);
  if (p.upper.size()) b.segment(m, n) = p.upper;
  if (p.lower.size()) b.tail(n) = -p.lower;
  return {A, b};
}

/// Largest violation of the Karush-Kuhn-Tucker conditions: stationarity, feasibility, sign, complementarity.
double kkt_residual(const QuadraticProgram& p, const QuadraticSolution& s) {
  const auto [A, b] = all_constraints(p);
  double worst = (s.x - p.target + A.transpose() * s.multipliers).cwiseAbs().maxCoeff();
  for (Index i = 0; i < b.size(); ++i) {
    if (!std::isfinite(b[i])) continue;
    const double slack = b[i] - A.row(i).dot(s.x);
    worst = std::max({worst, -slack, -s.multipliers[i], std::abs(slack * s.multipliers[i])});
  }
  return worst;
}

/// True when the multipliers prove that no x satisfies all constraints.
bool proves_infeasible(const QuadraticProgram& p, const VectorXd& y) {
  auto [A, b] = all_constraints(p);
  for (Index i = 0; i < b.size(); ++i) {
    if (!std::isfinite(b[i]) && y[i] != 0.0) return false;
    if (!std::isfinite(b[i])) b[i] = 0.0;
  }
  return y.minCoeff() >= 0.0 && (A.transpose() * y).cwiseAbs().maxCoeff() < 1e-9 * (1.0 + y.maxCoeff()) &&
         b.dot(y) < 0.0;
}

QuadraticProgram random_program(std::mt19937_64& random, Index n, Index m, double slack) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  QuadraticProgram p;
  p.target = VectorXd::NullaryExpr(n, [&] { return uniform(random); });
  p.matrix = MatrixXd::NullaryExpr(m, n, [&] { return uniform(random); });
  p.bounds = VectorXd::NullaryExpr(m, [&] { return slack + 0.3 * uniform(random); });
  const int kind = static_cast<int>(random() % 4);
  if (kind != 0) p.upper = VectorXd::NullaryExpr(n, [&] { return 0.6 + 0.5 * uniform(random); });
  if (kind != 1) p.lower = VectorXd::NullaryExpr(n, [&] { return -0.6 + 0.5 * uniform(random); });
  // Constraints as a voxel wall gives them: doubles, parallels, multiples, zeros.
  for (Index i = 1; i < m; ++i) {
    const int twist = static_cast<int>(random() % 12);
    if (twist == 0) p.matrix.row(i) = p.matrix.row(i - 1);
    if (twist == 1) p.matrix.row(i) = -2.0 * p.matrix.row(i - 1);
    if (twist == 2) p.matrix.row(i) += p.matrix.row(i - 1);
    if (twist == 3 && random() % 8 == 0) p.matrix.row(i).setZero();
  }
  return p;
}

/// The best point over every active set of at most n constraints, or nothing when no point is feasible.
std::optional<VectorXd> by_enumeration(const QuadraticProgram& p) {
  const auto [A, b] = all_constraints(p);
  const Index n = p.target.size(), m = b.size();
  std::optional<VectorXd> best;
  for (unsigned mask = 0; mask < (1u << m); ++mask) {
    std::vector<Index> set;
    for (Index i = 0; i < m; ++i) {
      if (mask >> i & 1u) set.push_back(i);
    }
    const Index count = static_cast<Index>(set.size());
    if (count > n) continue;
    MatrixXd K = MatrixXd::Zero(n + count, n + count);
    VectorXd h(n + count);
    K.topLeftCorner(n, n).setIdentity();
    h.head(n) = p.target;
    bool finite = true;
    for (Index i = 0; i < count; ++i) {
      finite = finite && std::isfinite(b[set[i]]);
      K.block(n + i, 0, 1, n) = A.row(set[i]);
      K.block(0, n + i, n, 1) = A.row(set[i]).transpose();
      h[n + i] = b[set[i]];
    }
    const Eigen::FullPivLU<MatrixXd> lu(K);
    if (!finite || !lu.isInvertible()) continue;
    const VectorXd x = lu.solve(h).head(n);
    bool feasible = true;
    for (Index i = 0; i < m; ++i) feasible = feasible && A.row(i).dot(x) <= b[i] + 1e-9;
    if (feasible && (!best || (x - p.target).norm() < (*best - p.target).norm())) best = x;
  }
  return best;
}

TEST(QuadraticProgram, SatisfiesTheOptimalityConditionsOrProvesInfeasibility) {
  std::mt19937_64 random(7);
  int feasible = 0, infeasible = 0;
  double worst = 0.0;
  for (int trial = 0; trial < 24000; ++trial) {
    const Index n = 1 + static_cast<Index>(random() % 14);
    const Index m = static_cast<Index>(random() % (trial % 20 == 0 ? 201 : 40));
    const QuadraticProgram p = random_program(random, n, m, trial % 3 == 0 ? 0.1 : 0.35);
    if (p.lower.size() && p.upper.size() && (p.upper - p.lower).minCoeff() < 0.0) continue;
    const QuadraticSolution s = solve(p);
    ASSERT_TRUE(s.x.allFinite() && s.multipliers.allFinite()) << trial;
    if (s.feasible) {
      ++feasible;
      worst = std::max(worst, kkt_residual(p, s));
      ASSERT_LE(kkt_residual(p, s), 1e-9) << trial << " n " << n << " m " << m;
    } else {
      ++infeasible;
      ASSERT_TRUE(proves_infeasible(p, s.multipliers)) << trial << " n " << n << " m " << m;
    }
  }
  EXPECT_GT(feasible, 5000);
  EXPECT_GT(infeasible, 500);
  RecordProperty("worst_kkt_residual", std::to_string(worst));
}

TEST(QuadraticProgram, AgreesWithTheEnumerationOfAllActiveSets) {
  std::mt19937_64 random(11);
  int solved = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Index n = 1 + static_cast<Index>(random() % 3);
    QuadraticProgram p = random_program(random, n, static_cast<Index>(random() % 5), 0.05);
    if (p.lower.size() && p.upper.size() && (p.upper - p.lower).minCoeff() < 0.0) continue;
    const QuadraticSolution s = solve(p);
    const auto expected = by_enumeration(p);
    ASSERT_EQ(s.feasible, expected.has_value()) << trial;
    if (!expected) continue;
    ++solved;
    EXPECT_NEAR((s.x - *expected).norm(), 0.0, 1e-8) << trial;
  }
  EXPECT_GT(solved, 500);
}

TEST(QuadraticProgram, LeavesAFeasibleTargetWhereItIs) {
  QuadraticProgram p;
  p.target = Eigen::Vector2d(0.3, -0.2);
  p.matrix = Eigen::RowVector2d(1.0, 1.0);
  p.bounds = Eigen::VectorXd::Constant(1, 0.5);
  const QuadraticSolution s = solve(p);
  EXPECT_TRUE(s.feasible);
  EXPECT_EQ(s.x, p.target);
  EXPECT_EQ(s.multipliers.cwiseAbs().maxCoeff(), 0.0);
}

TEST(QuadraticProgram, NamesTheConstraintThatCannotBeKept) {
  QuadraticProgram p;
  p.target = Eigen::Vector2d::Zero();
  p.matrix.resize(3, 2);
  p.matrix << 1, 0, 0, 1, -1, 0;
  p.bounds = Eigen::Vector3d(0.1, 0.1, -0.2);  // x <= 0.1 and x >= 0.2
  const QuadraticSolution s = solve(p);
  EXPECT_FALSE(s.feasible);
  EXPECT_TRUE(s.conflicting == 0 || s.conflicting == 2) << s.conflicting;
  EXPECT_TRUE(proves_infeasible(p, s.multipliers));
  p.matrix.row(2).setZero();  // 0 <= -0.2
  EXPECT_EQ(solve(p).conflicting, 2);
}

TEST(QuadraticProgram, RelaxesTheDemandsTogetherAndNothingElse) {
  QuadraticProgram p;  // two walls too near on both sides ask to back off, and x may not leave [-1, 1]
  p.target = Eigen::VectorXd::Constant(1, 0.9);
  p.matrix.resize(3, 1);
  p.matrix << 1, -1, 1;
  p.bounds = Eigen::Vector3d(-0.3, -0.1, 0.05);
  p.lower = Eigen::VectorXd::Constant(1, -1.0);
  p.upper = Eigen::VectorXd::Constant(1, 1.0);
  const QuadraticSolution s = solve_relaxed(p);
  EXPECT_TRUE(s.feasible);
  EXPECT_NEAR(s.demand, 0.0, 1e-5);
  EXPECT_NEAR(s.x[0], 0.0, 1e-5);

  p.bounds = Eigen::Vector3d(-0.3, 0.15, 0.05);  // only half of the separation can be had
  const QuadraticSolution half = solve_relaxed(p);
  EXPECT_TRUE(half.feasible);
  EXPECT_NEAR(half.demand, 0.5, 2e-6);
  EXPECT_NEAR(half.x[0], -0.15, 1e-6);
}

TEST(QuadraticProgram, RelaxationAlwaysSucceedsWhenStandingStillKeepsTheBox) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Index n = 1 + static_cast<Index>(random() % 7);
    QuadraticProgram p = random_program(random, n, 30, -0.05);
    p.lower = VectorXd::Constant(n, -0.05);
    p.upper = VectorXd::Constant(n, 0.05);
    const QuadraticSolution s = solve_relaxed(p);
    ASSERT_TRUE(s.feasible) << trial;
    for (Index i = 0; i < p.bounds.size(); ++i) {
      const double bound = p.bounds[i] < 0.0 ? s.demand * p.bounds[i] : p.bounds[i];
      ASSERT_LE(p.matrix.row(i).dot(s.x), bound + 1e-9);
    }
  }
}

TEST(QuadraticProgram, OnlyConstraintsOfAContradictionGiveWayAndAsLittleAsCanBe) {
  QuadraticProgram p;  // x_0 is squeezed between walls that both ask for 0.2; x_1 is asked to go -0.3 and can
  p.target = Eigen::Vector2d(0.1, 0.4);
  p.matrix.resize(3, 2);
  p.matrix << 1, 0, -1, 0, 0, 1;
  p.bounds = Eigen::Vector3d(-0.2, -0.2, -0.3);
  p.lower = Eigen::Vector2d::Constant(-1.0), p.upper = Eigen::Vector2d::Constant(1.0);
  const QuadraticSolution s = solve_relaxed(p);
  ASSERT_TRUE(s.feasible);
  EXPECT_NEAR((s.x - Eigen::Vector2d(0.0, -0.3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((s.shares - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(s.conflicting == 0 || s.conflicting == 1);
}

TEST(QuadraticProgram, TheSmallestShareIsTheLargestPossible) {
  std::mt19937_64 random(5);
  int relaxed = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Index n = 1 + static_cast<Index>(random() % 6);
    QuadraticProgram p = random_program(random, n, 12, 0.05);
    p.lower = VectorXd::Constant(n, -0.1);
    p.upper = VectorXd::Constant(n, 0.1);
    const QuadraticSolution s = solve_relaxed(p);
    ASSERT_TRUE(s.feasible) << trial;
    QuadraticProgram kept = p;
    for (Index i = 0; i < p.bounds.size(); ++i) {
      kept.bounds[i] *= p.bounds[i] < 0.0 ? s.shares[i] : 1.0;
      EXPECT_TRUE(p.bounds[i] < 0.0 || s.shares[i] == 1.0);
    }
    EXPECT_LE(kkt_residual(kept, s), 1e-9) << trial;
    if (s.demand == 1.0) continue;
    ++relaxed;
    const auto is_feasible_with = [&](double demand) {
      QuadraticProgram all = p;
      for (double& bound : all.bounds) bound *= bound < 0.0 ? demand : 1.0;
      return solve(all).feasible;
    };
    EXPECT_TRUE(s.demand < 1e-9 || is_feasible_with(s.demand * (1.0 - 1e-9))) << trial;
    EXPECT_FALSE(is_feasible_with(s.demand + 1e-9)) << trial;
  }
  EXPECT_GT(relaxed, 100);
}

TEST(QuadraticProgram, RefusesNotANumber) {
  QuadraticProgram p;
  p.target = Eigen::VectorXd::Zero(1);
  p.matrix = Eigen::MatrixXd::Constant(1, 1, std::nan(""));
  p.bounds = Eigen::VectorXd::Zero(1);
  EXPECT_THROW(solve(p), std::invalid_argument);
  p.matrix(0, 0) = 1.0;
  p.bounds[0] = -kInfinity;
  EXPECT_THROW(solve(p), std::invalid_argument);
  p.bounds = Eigen::VectorXd::Zero(2);
  EXPECT_THROW(solve(p), std::invalid_argument);
}

}  // namespace quadratic_program_test
}  // namespace clearway
