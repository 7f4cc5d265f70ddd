#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace clearway {

/// How a hand trembles or a walking person sways: motion whose frequencies lie in one band.
///
/// A healthy hand trembles between 6 and 12 Hz (Lakie et al. 2015), most people with a peak of 0.01 g near
/// 7 Hz, which is 0.035 mm rms, the shakiest of 97 with 0.035 g, which is 0.13 mm (Wade et al. 1982).
struct Shake {
  double shift = 0;  ///< m, root mean square along each axis
  double turn = 0;   ///< rad, root mean square about each axis
  double low_hz = 6, high_hz = 12;
};

/// One drawn shaking: a function of time whose spectrum is 12 tones, one in each twelfth of the band.
class ShakeMotion {
 public:
  /// @param stream distinguishes what shakes in one scene
  ShakeMotion(const Shake& shake, std::uint64_t seed, std::uint64_t stream);

  Eigen::Vector3d shift(double time) const;  ///< m
  Eigen::Vector3d turn(double time) const;   ///< rad, a rotation vector

 private:
  struct Tone {
    double turn_speed, phase;
  };
  Eigen::Vector3d sum(double time, std::size_t first, double rms) const;

  static constexpr std::size_t tones_of_an_axis = 12;
  Shake shake_;
  std::array<Tone, 6 * tones_of_an_axis> tones_;
};

}  // namespace clearway
