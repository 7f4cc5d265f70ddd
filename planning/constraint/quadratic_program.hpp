#pragma once

#include <Eigen/Core>

namespace clearway {

/// min 1/2 ||x - target||^2  subject to  matrix x <= bounds,  lower <= x <= upper.
/// The problem of the local step (Lahouar et al. 2006, eq. 3 and 9): a point projected on a polyhedron.
/// Infinite upper, lower and bounds are no constraint. Empty `lower` and `upper` mean no box.
struct QuadraticProgram {
  Eigen::VectorXd target;
  Eigen::MatrixXd matrix;  ///< m x n
  Eigen::VectorXd bounds;  ///< m
  Eigen::VectorXd lower, upper;
};

/// Constraints are numbered: 0..m-1 the inequalities, m+j the upper limit of x_j, m+n+j its lower limit.
struct QuadraticSolution {
  bool feasible = false;
  Eigen::VectorXd x;  ///< the solution; when infeasible the last iterate, of no meaning
  /// Feasible: Lagrange multipliers >= 0, x = target - sum multiplier_i a_i.
  /// Infeasible: a Farkas certificate: sum y_i a_i = 0, y >= 0, sum y_i b_i < 0; or all zero: none found.
  Eigen::VectorXd multipliers;
  int conflicting = -1;  ///< infeasible: a constraint of the contradiction, at which it was found
  int iterations = 0;
  double demand = 1.0;     ///< smallest share of a negative bound that was kept; see solve_relaxed
  Eigen::VectorXd shares;  ///< of each bound what was kept; 1 where nothing gave way
};

/// The exact solution by the dual active-set method of Goldfarb and Idnani (1983), Hessian = identity: see
/// QuadraticSolver, which loops use. Deterministic; never returns NaN.
/// @throws std::invalid_argument for sizes that do not match, NaN, a target beyond 1e100, rows beyond 1e150,
///         lower > upper, or a bound of -infinity.
QuadraticSolution solve(const QuadraticProgram& program);

/// The same; constraints that contradict each other are resolved by priority: limits, then constraints that
/// forbid approach (bounds >= 0), then demanded separations (negative bounds: bodies nearer than the security
/// distance). Those of the last kind that take part in a contradiction give way, to the largest common share
/// of their bounds that ends it; so the worst relative shortfall is the smallest possible. With all shares 0
/// nothing approaches. @pre lower <= 0 <= upper, so that x = 0 is feasible then.
QuadraticSolution solve_relaxed(const QuadraticProgram& program);

}  // namespace clearway
