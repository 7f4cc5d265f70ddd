#include "planning/constraint/quadratic_program.hpp"

#include <stdexcept>

#include "planning/constraint/quadratic_solver.hpp"

namespace clearway {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::span<const double> numbers(const VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

VectorXd vector_of(std::span<const double> numbers) {
  return Eigen::Map<const VectorXd>(numbers.data(), static_cast<Index>(numbers.size()));
}

/// The problem in a solver of this thread, which keeps its memory.
QuadraticSolver& loaded(const QuadraticProgram& p) {
  const Index n = p.target.size();
  const bool sizes = p.matrix.rows() == p.bounds.size() && (p.matrix.rows() == 0 || p.matrix.cols() == n) &&
                     (p.lower.size() == 0 || p.lower.size() == n) &&
                     (p.upper.size() == 0 || p.upper.size() == n);
  if (!sizes) throw std::invalid_argument("quadratic program: sizes of target, rows and bounds do not match");
  thread_local QuadraticSolver solver;
  thread_local VectorXd normal, lower, upper;
  const double infinity = std::numeric_limits<double>::infinity();
  lower = p.lower.size() ? p.lower : VectorXd::Constant(n, -infinity);
  upper = p.upper.size() ? p.upper : VectorXd::Constant(n, infinity);
  solver.begin(static_cast<int>(n));
  solver.set_target(numbers(p.target));
  solver.set_limits(numbers(lower), numbers(upper));
  for (Index i = 0; i < p.matrix.rows(); ++i) {
    normal = p.matrix.row(i).transpose();
    solver.add_constraint(numbers(normal), p.bounds[i]);
  }
  return solver;
}

QuadraticSolution reported(const QuadraticSolver& solver, bool is_feasible) {
  QuadraticSolution solution;
  solution.feasible = is_feasible;
  solution.x = vector_of(solver.x());
  solution.multipliers = vector_of(solver.multipliers());
  solution.conflicting = solver.conflicting();
  solution.iterations = solver.iterations();
  solution.shares = vector_of(solver.shares());
  solution.demand = solver.smallest_share();
  return solution;
}

}  // namespace

QuadraticSolution solve(const QuadraticProgram& program) {
  QuadraticSolver& solver = loaded(program);
  const bool is_feasible = solver.solve();
  return reported(solver, is_feasible);
}

QuadraticSolution solve_relaxed(const QuadraticProgram& program) {
  QuadraticSolver& solver = loaded(program);
  const bool is_feasible = solver.solve_relaxed();
  return reported(solver, is_feasible);
}

}  // namespace clearway
