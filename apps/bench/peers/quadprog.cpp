#include "apps/bench/peers/quadprog.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>

namespace clearway::bench {

Quadprog::Quadprog() {
  void* const library = dlopen("/usr/lib/R/site-library/quadprog/libs/quadprog.so", RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) return;
  library_.reset(library, dlclose);
  solve_ = reinterpret_cast<Solve>(dlsym(library, "qpgen2_"));
}

Quadprog::Program Quadprog::prepare(const QuadraticProgram& program) {
  const Eigen::Index n = program.target.size();
  Program prepared;
  prepared.variables = static_cast<int>(n);
  prepared.target.assign(program.target.begin(), program.target.end());
  const auto add = [&](const auto& normal, double bound) {  // normal x <= bound
    if (!std::isfinite(bound)) return;
    for (Eigen::Index j = 0; j < n; ++j) prepared.normals.push_back(-normal(j));
    prepared.bounds.push_back(-bound);
  };
  for (Eigen::Index i = 0; i < program.matrix.rows(); ++i)
    add([&](Eigen::Index j) { return program.matrix(i, j); }, program.bounds[i]);
  for (Eigen::Index k = 0; k < program.upper.size(); ++k)
    add([&](Eigen::Index j) { return j == k ? 1.0 : 0.0; }, program.upper[k]);
  for (Eigen::Index k = 0; k < program.lower.size(); ++k)
    add([&](Eigen::Index j) { return j == k ? -1.0 : 0.0; }, -program.lower[k]);
  return prepared;
}

const std::vector<double>& Quadprog::solve(const Program& program) {
  const int n = program.variables, count = static_cast<int>(program.bounds.size()), equalities = 0;
  const auto size = static_cast<std::size_t>(n), constraints = program.bounds.size();
  matrix_.assign(size * size, 0.0);  // the inverse of the Hessian's root, which the solver overwrites
  for (std::size_t i = 0; i < size; ++i) matrix_[i * size + i] = 1.0;
  vector_ = program.target;
  solution_.resize(size);
  multipliers_.resize(constraints);
  active_.resize(constraints);
  const std::size_t least = std::min(size, constraints);
  work_.resize(2 * size + least * (least + 5) / 2 + 2 * constraints + 1);
  double value = 0.0;  // rows and bounds of equalities alone are changed, and there are none
  int active_count = 0, iterations[2] = {0, 0}, state = 1;  // 1: the matrix is factored already
  solve_(matrix_.data(), vector_.data(), &n, &n, solution_.data(), multipliers_.data(), &value,
         const_cast<double*>(program.normals.data()), const_cast<double*>(program.bounds.data()), &n, &count,
         &equalities, active_.data(), &active_count, iterations, work_.data(), &state);
  if (state != 0) solution_.clear();
  return solution_;
}

}  // namespace clearway::bench
