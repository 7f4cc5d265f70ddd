#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning/constraint/quadratic_program.hpp"

namespace clearway::bench {

/// Turlach's quadprog, the solver behind R's and Python's `quadprog`: the dual method of Goldfarb and Idnani
/// in compiled code, called without R. Debian has it in r-cran-quadprog, whose library is opened at run time.
class Quadprog {
 public:
  Quadprog();

  /// False without the package.
  bool is_there() const { return solve_ != nullptr; }
  static std::string package() { return "r-cran-quadprog"; }

  /// A program as the solver takes it: limits as rows, one constraint a column.
  struct Program {
    int variables = 0;
    std::vector<double> target, normals, bounds;  ///< normals^T x >= bounds
  };
  static Program prepare(const QuadraticProgram& program);

  /// The solution, until the next call; empty when there is none. @pre is_there()
  const std::vector<double>& solve(const Program& program);

 private:
  using Solve = void (*)(double* matrix, double* vector, const int* matrix_rows, const int* variables,
                         double* solution, double* multipliers, double* value, double* normals,
                         double* bounds, const int* normal_rows, const int* constraints,
                         const int* equalities, int* active, int* active_count, int* iterations, double* work,
                         int* state);
  std::shared_ptr<void> library_;
  Solve solve_ = nullptr;
  std::vector<double> matrix_, vector_, solution_, multipliers_, work_;
  std::vector<int> active_;
};

}  // namespace clearway::bench
