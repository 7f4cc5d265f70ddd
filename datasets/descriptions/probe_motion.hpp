#pragma once

#include <vector>

#include "datasets/descriptions/scene.hpp"

namespace clearway {

/// The exact motion of the probe along a stroke.
class ProbeMotion {
 public:
  ProbeMotion(const SceneStroke& stroke, const ProbeSetup& probe);

  double begin() const;                                  ///< s after the first picture
  double duration() const { return duration_; }          ///< s, when it ends
  double length() const { return knots_.back().along; }  ///< m, of the ball's way

  /// Centre of the ball and pose of the probe's board, `time` seconds (clamped) after the stroke began.
  struct State {
    Eigen::Vector3d map_ball;
    Eigen::Isometry3d map_from_probe;
  };
  State at(double time) const;

 private:
  struct Knot {
    double along;  ///< m of way up to here
    Eigen::Vector3d ball;
    double waypoint;  ///< index and part of the way to the next
  };
  Knot knot_at(double time) const;

  SceneStroke stroke_;
  ShakeMotion tremor_;
  Eigen::Vector3d ball_center_;
  std::vector<Knot> knots_;  ///< the same number from waypoint to waypoint
  double duration_;
};

}  // namespace clearway
