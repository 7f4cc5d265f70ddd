#include "tracking/dense.hpp"

#include <Eigen/Eigenvalues>

namespace clearway {

Eigen::MatrixXd product(const Dense& a, const Dense& b) { return a * b; }

Eigen::MatrixXd transposed_product(const Dense& a, const Dense& b) { return a.transpose() * b; }

Eigen::MatrixXd squared(const Dense& a) { return a * a.transpose(); }

Eigen::MatrixXd sandwich(const Dense& a, const Dense& b) { return a * (b * a.transpose()); }

Cholesky::Cholesky(const Dense& matrix) : solver_(matrix) {}

Eigen::MatrixXd Cholesky::solve(const Dense& right) const { return solver_.solve(right); }

Eigen::MatrixXd Cholesky::inverse() const {
  return solve(Eigen::MatrixXd::Identity(solver_.rows(), solver_.cols()));
}

double Cholesky::squared(const Dense& column) const {
  return transposed_product(column, solve(column))(0, 0);
}

Eigen::MatrixXd Cholesky::whitening() const {
  return solver_.matrixL().solve(Eigen::MatrixXd::Identity(solver_.rows(), solver_.cols()));
}

Eigen::MatrixXd solve_symmetric(const Dense& matrix, const Dense& right) {
  const Eigen::LDLT<Eigen::MatrixXd> solver(matrix);
  return solver.solve(right);
}

PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace clearway
