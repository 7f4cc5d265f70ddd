#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>

namespace clearway {

/// Small dense algebra that is compiled once, for any sizes. Eigen instantiates its solvers and products anew
/// for each pair of sizes, which took the compiler two thirds of this floor's time; none of it is a hot loop.
using Dense = Eigen::Ref<const Eigen::MatrixXd>;

/// a b
Eigen::MatrixXd product(const Dense& a, const Dense& b);
/// a^T b
Eigen::MatrixXd transposed_product(const Dense& a, const Dense& b);
/// a a^T
Eigen::MatrixXd squared(const Dense& a);
/// a b a^T
Eigen::MatrixXd sandwich(const Dense& a, const Dense& b);

/// Solves with a symmetric positive definite matrix, by Cholesky's decomposition.
class Cholesky {
 public:
  explicit Cholesky(const Dense& matrix);

  /// False when the matrix is not positive definite: nothing else holds then.
  bool is_positive() const { return solver_.info() == Eigen::Success; }
  Eigen::MatrixXd solve(const Dense& right) const;
  Eigen::MatrixXd inverse() const;
  /// b^T A^-1 b of a column.
  double squared(const Dense& column) const;
  /// L^-1 of A = L L^T: whitens what has covariance A.
  Eigen::MatrixXd whitening() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> solver_;
};

/// The solution of a symmetric system, by L D L^T with pivots: also where the matrix is hardly positive.
Eigen::MatrixXd solve_symmetric(const Dense& matrix, const Dense& right);

/// Eigenvalues of a symmetric 3 x 3 matrix, rising, with their axes as columns.
struct PrincipalAxes {
  Eigen::Vector3d values;
  Eigen::Matrix3d axes;
};
PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric);

}  // namespace clearway
