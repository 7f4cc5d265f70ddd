#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// A group of balls that one movement of a hand painted (or erased): what is undone together. Its time span
/// is that of its balls.
struct Stroke {
  std::string label;
  std::string source;             ///< who painted: a sensor label, a person; may be empty
  double begin = 0.0, end = 0.0;  ///< seconds, of its first and last ball

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

/// One painted collision-free volume (CFV): the exact union of its balls, Chong et al. 2008, eq. 2.
/// The voxels of the map are a conservative copy of it (painted voxel => wholly inside one ball).
/// This holds after erasing too, because an eraser shrinks the balls themselves (`shrunk`).
struct PaintedVolume {
  std::string label;
  std::vector<std::string> critical_parts;  ///< robot parts that must stay inside this volume
  std::vector<Sphere> balls{};              ///< in the order painted
  std::vector<double> times{};              ///< seconds, one per ball (0 where unknown)
  std::vector<Stroke> strokes{};            ///< that painted here, in the order of their first balls
  std::vector<int> stroke_of{};  ///< of each ball: index into `strokes`, -1 for none; empty: none for all

  /// True when `point` (map frame) lies in the closed union of the balls.
  bool contains(const Eigen::Vector3d& point) const;

  /// The stroke of ball `ball`, null when it belongs to none.
  const Stroke* stroke(std::size_t ball) const;

  /// Adds a ball of stroke `stroke` (index into `strokes`, -1 for none) and stretches the stroke's time span.
  void add(const Sphere& ball, double time, int stroke);
};

/// What an eraser leaves of a painted ball: the same centre, and the radius at which the two balls only touch
/// (rounded down). None when nothing is left. A ball that the eraser does not reach comes back as it is.
std::optional<Sphere> shrunk(const Sphere& ball, const Sphere& eraser);

/// True when a label or part can be stored: no control characters.
bool is_storable_name(std::string_view name);

}  // namespace clearway
