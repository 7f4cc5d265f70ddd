#pragma once

#include <Eigen/Core>

namespace clearway {

/// min 1/2 ||x - target||^2  subject to  rows x <= bounds,  lower <= x <= upper.
/// The problem of the local step (Lahouar et al. 2006, eq. 3 and 9): a point projected on a polyhedron.
/// Infinite upper, lower and bounds are no constraint. Empty `lower` and `upper` mean no box.
struct QuadraticProgram {
  Eigen::VectorXd target;
  Eigen::MatrixXd rows;    ///< m x n
  Eigen::VectorXd bounds;  ///< m
  Eigen::VectorXd lower, upper;
};

/// Constraints are numbered: 0..m-1 the rows, m+j the upper limit of x_j, m+n+j its lower limit.
struct QuadraticSolution {
  bool feasible = false;
  Eigen::VectorXd x;  ///< the solution; when infeasible the last iterate, of no meaning
  /// Feasible: Lagrange multipliers >= 0, x = target - sum multiplier_i a_i.
  /// Infeasible: a Farkas certificate: sum y_i a_i = 0, y >= 0, sum y_i b_i < 0.
  Eigen::VectorXd multipliers;
  int conflicting = -1;  ///< infeasible: the constraint that cannot join those with y_i > 0
  int iterations = 0;
  double demand = 1.0;  ///< share of the negative bounds that was kept; see solve_relaxed
};

/// The exact solution by the dual active-set method of Goldfarb and Idnani (1983), Hessian = identity.
/// Deterministic; never returns NaN. Works for a few dozen variables (each step factors the active rows).
/// @throws std::invalid_argument for sizes that do not match, NaN, an infinite target, lower > upper, or a
///         bound of -infinity.
QuadraticSolution solve(const QuadraticProgram& program);

/// The same; when it is infeasible, the constraints that demand motion (negative bounds of `rows`: bodies
/// nearer than the security distance) are relaxed together: bounds_i < 0 become demand * bounds_i with the
/// largest demand in [0, 1] that is feasible (bisection to 2^-20). So the worst relative shortfall is the
/// smallest possible, the box is always kept and no other row gives way; with demand = 0 nothing approaches.
/// @pre lower <= 0 <= upper, so that x = 0 is feasible at demand 0.
QuadraticSolution solve_relaxed(QuadraticProgram program);

}  // namespace clearway
