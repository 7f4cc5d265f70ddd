#pragma once

#include "tracking/tag_body.hpp"

namespace clearway {

/// The hand-held probe: a tag body with a physical ball on it.
struct PaintingProbe {
  TagBody body;
  Eigen::Vector3d ball_in_probe =
      Eigen::Vector3d::Zero();  ///< W_T_W' of Chong 2008, eq. 1: the ball's centre, metres
  double ball_radius = 0.0;     ///< r, metres

  /// Throws std::invalid_argument naming the field and what was expected.
  void validate() const;
};

/// What Chong 2008, eq. 3 takes off the ball's radius, metres each.
struct ErrorBudget {
  double robot = 0.001;      ///< the robot's position error while it moves along a path
  double tracking = 0.005;   ///< the error of a painted centre, when it is constant
  double modelling = 0.001;  ///< of the probe (ball, tag mounting) and of the robot's bodies
  /// As in the paper: every sample pays `tracking`, and one whose own bound is larger is refused. Otherwise
  /// each sample pays its own bound (CenterBound::total).
  bool constant_tracking = false;

  /// What a sample of that bound pays, metres.
  double sum(double bound) const { return robot + (constant_tracking ? tracking : bound) + modelling; }
};

/// Throws std::invalid_argument when an error is negative or not finite, or when the budget leaves nothing of
/// the ball whatever the bound.
void validate(const ErrorBudget& budget, double ball_radius);

/// Eq. 3 of Chong et al. 2008: r0 = r - (robot + tracking + modelling), metres, where `bound` is how far the
/// sample's centre may be off; 0 when nothing is left of the ball. Throws as validate().
double painted_radius(double ball_radius, const ErrorBudget& budget, double bound);

/// A sphere of free space in the base frame, metres: S_i(c_i, r0) of Chong 2008, eq. 2.
struct PaintedSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

}  // namespace clearway
