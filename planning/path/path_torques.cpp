#include "planning/path/path_torques.hpp"

#include <cmath>

namespace clearway {
namespace {

constexpr double least_left = 0.01;  ///< of a limit, where gravity takes more

std::vector<Eigen::Index> limited_joints(const Eigen::VectorXd& limits) {
  std::vector<Eigen::Index> joints;
  for (Eigen::Index j = 0; j < limits.size(); ++j)
    if (std::isfinite(limits[j])) joints.push_back(j);
  return joints;
}

}  // namespace

std::vector<StretchTorques> torques_along(const SmoothPath& path, const std::vector<PathStretch>& stretches,
                                          const Robot& robot, const TorqueTerms& terms,
                                          const Eigen::VectorXd& limits) {
  const std::vector<Eigen::Index> joints = limited_joints(limits);
  const Eigen::VectorXd most = limits(joints), rest = Eigen::VectorXd::Zero(limits.size());
  const auto bounds_at = [&](const PathPiece& piece, double s) {
    const Configuration q = piece.at(s);
    const Eigen::VectorXd slope = piece.slope(s), held = joint_torques(robot, q, rest, rest, terms);
    const auto beside_gravity = [&](const Eigen::VectorXd& velocity, const Eigen::VectorXd& acceleration) {
      return Eigen::VectorXd((joint_torques(robot, q, velocity, acceleration, terms) - held)(joints));
    };
    return TorqueBounds{beside_gravity(rest, slope), beside_gravity(slope, piece.bend),
                        (-most - held(joints)).cwiseMin(-least_left * most),
                        (most - held(joints)).cwiseMax(least_left * most)};
  };
  std::vector<StretchTorques> torques;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const PathStretch& stretch = stretches[k];
    const PathPiece& piece = path.pieces[stretch.piece];
    const bool goes_on = k > 0 && stretches[k - 1].piece == stretch.piece;
    torques.push_back({goes_on ? torques.back().end : bounds_at(piece, stretch.begin),
                       bounds_at(piece, stretch.begin + stretch.length)});
  }
  return torques;
}

}  // namespace clearway
