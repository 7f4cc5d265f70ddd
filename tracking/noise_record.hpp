#pragma once

#include "tracking/tag_body.hpp"

namespace clearway {

/// The corners' noise as the residuals of a body's poses show it over time. Errors of sizes and places are in
/// the residuals too and pass for noise; a bias that all tags share is not, and is stated apart
/// (BodyPoseOptions::edge_bias).
class NoiseRecord {
 public:
  void note(const BodyPose& pose);

  /// Standard deviation of a corner per axis, pixels: at most `stated`; below it only as far as the residuals
  /// of the last fifty images, about, show by two of their own standard deviations; at least `least`.
  double noise(double stated, double least) const;

 private:
  double squares_ = 0.0, freedom_ = 0.0;  // of the residuals, older ones forgotten
};

}  // namespace clearway
