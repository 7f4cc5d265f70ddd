#pragma once

#include <cstddef>
#include <vector>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// A piece of a path in joint space: q(s) = begin + direction s + bend s^2 / 2 for 0 <= s <= length.
struct PathPiece {
  static constexpr std::size_t no_corner = static_cast<std::size_t>(-1);

  Configuration begin;
  Eigen::VectorXd direction;       ///< dq/ds where it begins
  Eigen::VectorXd bend;            ///< d2q/ds2; zero on a straight piece
  double length = 0.0;             ///< of the parameter s, rad or m
  std::size_t corner = no_corner;  ///< the waypoint that a blend passes; none on a straight piece

  bool is_straight() const { return corner == no_corner; }
  Configuration at(double s) const { return begin + s * direction + (0.5 * s * s) * bend; }
  Eigen::VectorXd slope(double s) const { return direction + s * bend; }
};

/// Straight edges joined by parabolas: dq/ds is continuous, d2q/ds2 constant on each piece.
struct SmoothPath {
  std::vector<PathPiece> pieces;
  Configuration begin, end;

  double length() const;
};

/// The polyline with each inner waypoint cut by a parabola that leaves its edges `reach[i]` before and behind
/// waypoint i, touching both. It stays in the triangle of these two points and the waypoint, so that no
/// joint is farther than reach[i] / 4 times the change of its direction from the edges.
/// @pre neighbours differ; 0 < reach[i] of inner waypoints, and the two reaches of an edge are together no
///      longer than it.
SmoothPath blended_path(const std::vector<Configuration>& waypoints, const std::vector<double>& reach);

}  // namespace clearway
