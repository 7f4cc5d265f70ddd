#include "tracking/static_board.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tracking/dense.hpp"

namespace clearway {

StaticBoard::StaticBoard(const StaticBoardOptions& options) : options_(options) {
  if (options.memory < 1 || options.memory > 10000)
    throw std::invalid_argument("static board: memory must be 1 to 10000 images");
  if (!(options.gate_sigmas > 0.0)) throw std::invalid_argument("static board: gate_sigmas must be > 0");
  if (options.reset_after < 1) throw std::invalid_argument("static board: reset_after must be 1 or more");
}

std::optional<UncertainPose> StaticBoard::add(const UncertainPose& seen) {
  if (!mean_) {
    mean_ = seen;
    return mean_;
  }
  const Vector6d innovation = difference(mean_->pose, seen.pose);
  const Matrix6d prior = mean_->covariance * (1.0 + 1.0 / options_.memory);
  const Cholesky sum(prior + seen.covariance);
  const double distance = sum.squared(innovation);
  if (!(distance <= options_.gate_sigmas * options_.gate_sigmas)) {
    if (++disagreeing_ >= options_.reset_after) {
      const double step = (seen.pose.translation() - mean_->pose.translation()).norm();
      moves_ = {moves_.count + 1, std::max(moves_.farthest, step)};
      mean_ = seen;
      disagreeing_ = 0;
    }
    return std::nullopt;
  }
  disagreeing_ = 0;
  const Matrix6d gain = sum.solve(prior).transpose();
  mean_->pose = moved(mean_->pose, product(gain, innovation));
  mean_->pose.linear() = Eigen::Quaterniond(mean_->pose.linear()).normalized().toRotationMatrix();
  const Matrix6d covariance = prior - product(gain, prior);
  mean_->covariance = 0.5 * (covariance + covariance.transpose());
  return mean_;
}

}  // namespace clearway
