#include "tracking/noise_record.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

void NoiseRecord::note(const BodyPose& pose) {
  constexpr double memory = 0.98;  // of each image before: 50 images, about
  const double corners = 0.5 * pose.freedom + 3.0;
  squares_ = memory * squares_ + corners * pose.rms_px * pose.rms_px;
  freedom_ = memory * freedom_ + pose.freedom;
}

double NoiseRecord::noise(double stated, double least) const {
  constexpr double fewest = 20.0;  // degrees of freedom: fewer say nothing
  if (freedom_ < fewest) return stated;
  const double seen = std::sqrt(squares_ / freedom_) * (1.0 + 2.0 / std::sqrt(2.0 * freedom_));
  return std::min(stated, std::max(seen, least));
}

}  // namespace clearway
