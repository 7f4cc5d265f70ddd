#pragma once

// Not part of the installed library.

#include <cstddef>
#include <vector>

#include "planning/path/smooth_path.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// What torque limits ask at a place on a path, a value for each joint that has one: with path acceleration u
/// and path speed squared x, low <= along u + across x <= high, of which gravity has its part.
struct TorqueBounds {
  Eigen::VectorXd along, across, low, high;
};

/// At both ends of a part of a piece.
struct StretchTorques {
  TorqueBounds begin, end;
};

/// A part of a piece of a path.
struct PathStretch {
  std::size_t piece = 0;
  double begin = 0.0, length = 0.0;  ///< parameter of the piece
};

/// Of each stretch: torques are linear in u and x (Bobrow, Dubowsky and Gibson, "Time-optimal control of
/// robotic manipulators along specified paths", 1985).
/// @param limits N m or N, infinity where there is none; beyond what gravity takes on the path
std::vector<StretchTorques> torques_along(const SmoothPath& path, const std::vector<PathStretch>& stretches,
                                          const Robot& robot, const TorqueTerms& terms,
                                          const Eigen::VectorXd& limits);

}  // namespace clearway
