#include "datasets/descriptions/shake.hpp"

#include <cmath>
#include <numbers>

#include "datasets/descriptions/random_numbers.hpp"

namespace clearway {

ShakeMotion::ShakeMotion(const Shake& shake, std::uint64_t seed, std::uint64_t stream) : shake_(shake) {
  const RandomNumbers numbers(seed, stream);
  for (std::size_t i = 0; i < tones_.size(); ++i) {
    const double place = static_cast<double>(i % tones_of_an_axis) + numbers.uniform(2 * i);
    const double hz = shake.low_hz + (shake.high_hz - shake.low_hz) * place / tones_of_an_axis;
    tones_[i] = {2 * std::numbers::pi * hz, 2 * std::numbers::pi * numbers.uniform(2 * i + 1)};
  }
}

/// The mean square of a sine is a half.
Eigen::Vector3d ShakeMotion::sum(double time, std::size_t first, double rms) const {
  if (rms == 0.0) return Eigen::Vector3d::Zero();
  const double amplitude = rms * std::sqrt(2.0 / tones_of_an_axis);
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3 * tones_of_an_axis; ++i) {
    const Tone& tone = tones_[first + i];
    result[static_cast<Eigen::Index>(i / tones_of_an_axis)] +=
        amplitude * std::sin(tone.turn_speed * time + tone.phase);
  }
  return result;
}

Eigen::Vector3d ShakeMotion::shift(double time) const { return sum(time, 0, shake_.shift); }

Eigen::Vector3d ShakeMotion::turn(double time) const { return sum(time, 3 * tones_of_an_axis, shake_.turn); }

}  // namespace clearway
