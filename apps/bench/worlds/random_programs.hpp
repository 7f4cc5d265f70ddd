#pragma once

// Random quadratic programs of many kinds, and a judge of their solutions that knows no solver: the
// Karush-Kuhn-Tucker conditions, or the proof of infeasibility, in long double.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/constraint/quadratic_program.hpp"

namespace clearway::bench {

/// What makes a program hard.
enum class ProgramKind {
  plain,
  walls,          ///< constraints doubled, turned round, summed up, zero: as neighbouring voxels give them
  near_parallel,  ///< constraints that differ by 1e-2 to 1e-14
  scales,         ///< lengths of constraints over 16 decades, the whole over 12
  squeezed,       ///< bounds that contradict each other more often than not
  vertex,  ///< more constraints than variables through one point, which keeps the limits: always feasible
  damper   ///< of an arm: short constraints, demands below the security distance, a small box
};
inline constexpr std::array program_kinds{"plain",    "walls",  "near_parallel", "scales",
                                          "squeezed", "vertex", "damper"};

class ProgramDice {
 public:
  explicit ProgramDice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * random_unit(engine_); }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  Eigen::VectorXd vector(Eigen::Index size, double half) {
    return Eigen::VectorXd::NullaryExpr(size, [&] { return between(-half, half); });
  }

 private:
  std::mt19937_64 engine_;
};

/// What its kind changes of a plain program.
inline void complicate(ProgramDice& dice, ProgramKind kind, QuadraticProgram& p) {
  const Eigen::Index n = p.target.size(), m = p.matrix.rows();
  const auto each_constraint = [&](const auto& change) {
    for (Eigen::Index i = 1; i < m; ++i) change(i, dice.below(12));
  };
  switch (kind) {
    case ProgramKind::plain:
    case ProgramKind::squeezed:
      break;
    case ProgramKind::walls:
      each_constraint([&](Eigen::Index i, int twist) {
        if (twist == 0) p.matrix.row(i) = p.matrix.row(i - 1);
        if (twist == 1) p.matrix.row(i) = -2.0 * p.matrix.row(i - 1);
        if (twist == 2) p.matrix.row(i) += p.matrix.row(i - 1);
        if (twist == 3 && dice.below(8) == 0) p.matrix.row(i).setZero();
      });
      break;
    case ProgramKind::near_parallel:
      each_constraint([&](Eigen::Index i, int twist) {
        if (twist >= 8) return;
        const double off = std::pow(10.0, -dice.between(2.0, 14.0));
        p.matrix.row(i) = p.matrix.row(i - 1) + off * dice.vector(n, 1.0).transpose();
        p.bounds[i] = p.bounds[i - 1] + (twist < 4 ? off * dice.between(-1.0, 1.0) : 0.0);
      });
      break;
    case ProgramKind::scales: {
      for (Eigen::Index i = 0; i < m; ++i) {
        const double factor = std::pow(10.0, dice.between(-8.0, 8.0));
        p.matrix.row(i) *= factor;
        p.bounds[i] *= factor;
      }
      const double size = std::pow(10.0, dice.between(-6.0, 6.0));
      p.target *= size;
      p.bounds *= size;
      p.upper *= size;
      p.lower *= size;
      break;
    }
    case ProgramKind::vertex: {
      const Eigen::VectorXd at = dice.vector(n, 0.3);
      p.bounds = p.matrix * at;
      if (p.upper.size() != 0) p.upper = p.upper.cwiseMax(at);
      if (p.lower.size() != 0) p.lower = p.lower.cwiseMin(at);
      break;
    }
    case ProgramKind::damper:
      p.target = dice.vector(n, 0.01);
      p.matrix *= 0.5;
      p.bounds = dice.vector(m, 0.01).array() + 0.006;
      p.lower = Eigen::VectorXd::Constant(n, -0.02);
      p.upper = Eigen::VectorXd::Constant(n, 0.02);
      break;
  }
}

/// `most_constraints` at most; up to 14 variables, and limits on some, all or none.
inline QuadraticProgram random_program(ProgramDice& dice, ProgramKind kind, int most_constraints) {
  const Eigen::Index n = 1 + dice.below(14), m = dice.below(most_constraints + 1);
  QuadraticProgram p;
  p.target = dice.vector(n, 1.0);
  p.matrix.resize(m, n);
  for (Eigen::Index i = 0; i < m; ++i) p.matrix.row(i) = dice.vector(n, 1.0).transpose();
  const double room = kind == ProgramKind::squeezed ? -0.1 : std::array{0.35, 0.15, 0.05}[dice.below(3)];
  p.bounds = dice.vector(m, 0.3).array() + room;
  const int limits = dice.below(4);  // never lower > upper
  if (limits != 0) p.upper = dice.vector(n, 0.5).array() + 0.6;
  if (limits != 1) p.lower = dice.vector(n, 0.5).array() - 0.6;
  complicate(dice, kind, p);
  return p;
}

/// How far a solution is from the conditions, or a proof of infeasibility from being one.
struct Judgement {
  double relative = 0.0;  ///< to the size of the terms that enter each condition, constraints of unit length
  double absolute = 0.0;  ///< the same as they stand; infeasible: 0
  bool is_number = true;  ///< all of the solution is finite
};

inline Judgement judge(const QuadraticProgram& p, const QuadraticSolution& s) {
  using Real = long double;
  const Eigen::Index n = p.target.size(), m = p.matrix.rows();
  Judgement judgement{0.0, 0.0, s.x.allFinite() && s.multipliers.allFinite()};
  const Real size = static_cast<Real>(p.target.norm()) + static_cast<Real>(s.x.norm());
  Eigen::Matrix<Real, Eigen::Dynamic, 1> sum = Eigen::Matrix<Real, Eigen::Dynamic, 1>::Zero(n);
  Real heaviest = 0.0L, gap = 0.0L, gap_terms = 0.0L;
  const auto note = [&](Real residual, Real terms) {
    if (!(residual > 0.0L)) return;
    judgement.absolute = std::max(judgement.absolute, static_cast<double>(residual));
    judgement.relative = std::max(judgement.relative, static_cast<double>(residual / terms));
  };
  const auto each =
      [&](const auto& visit) {  // (multiplier of the normalized constraint, length, bound, constraint)
        for (Eigen::Index i = 0; i < m; ++i)
          visit(i, static_cast<Real>(p.matrix.row(i).stableNorm()), p.bounds[i]);
        for (Eigen::Index j = 0; p.upper.size() && j < n; ++j) visit(m + j, 1.0L, p.upper[j]);
        for (Eigen::Index j = 0; p.lower.size() && j < n; ++j) visit(m + n + j, 1.0L, -p.lower[j]);
      };
  each([&](Eigen::Index i, Real length, double) {
    heaviest = std::max(heaviest, static_cast<Real>(s.multipliers[i]) * (length > 0.0L ? length : 1.0L));
  });
  each([&](Eigen::Index i, Real length, double bound) {
    const Real unit = length > 0.0L ? length : 1.0L, y = static_cast<Real>(s.multipliers[i]);
    Real value = 0.0L;
    for (Eigen::Index j = 0; j < n; ++j) {
      const Real a = i < m ? static_cast<Real>(p.matrix(i, j)) : i < m + n ? i - m == j : -(i - m - n == j);
      value += a * static_cast<Real>(s.x[j]);
      sum[j] += y * a;
    }
    note(-y * unit, heaviest + size);
    gap += y * static_cast<Real>(bound);
    gap_terms += std::abs(y * static_cast<Real>(bound));
    if (!s.feasible) return;
    const Real slack = (static_cast<Real>(bound) - value) / unit;
    const Real terms = size + std::abs(static_cast<Real>(bound)) / unit;
    note(-slack, terms);
    note(std::abs(slack * y * unit), terms * (size + heaviest));
  });
  if (s.feasible) {
    for (Eigen::Index j = 0; j < n; ++j)
      note(std::abs(static_cast<Real>(s.x[j]) - static_cast<Real>(p.target[j]) + sum[j]), size + heaviest);
  } else {
    const Real rest = sum.cwiseAbs().maxCoeff();
    judgement.relative =
        std::max(judgement.relative, static_cast<double>(rest / std::max(heaviest, 1e-300L)));
    judgement.absolute = 0.0;
    if (!(-gap > 1e-14L * gap_terms)) judgement.relative = std::numeric_limits<double>::infinity();
  }
  return judgement;
}

}  // namespace clearway::bench
