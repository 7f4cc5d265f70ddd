#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// A group of spheres that one movement of a hand painted (or erased): what is undone together. Its time span
/// is that of its spheres.
struct Stroke {
  std::string label;
  std::string source;             ///< who painted: a sensor label, a person; may be empty
  double begin = 0.0, end = 0.0;  ///< seconds, of its first and last sphere

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

/// One painted collision-free volume (CFV): the exact union of its spheres, Chong et al. 2008, eq. 2.
/// The voxels of the map are a conservative copy of it (painted voxel => wholly inside one sphere).
/// This holds after erasing too, because an eraser shrinks the spheres themselves (`shrunk`).
struct PaintedVolume {
  std::string label;
  std::vector<std::string> critical_parts;  ///< robot parts that must stay inside this volume
  std::vector<Sphere> spheres{};            ///< in the order painted
  std::vector<double> times{};              ///< seconds, one per sphere (0 where unknown)
  std::vector<Stroke> strokes{};            ///< that painted here, in the order of their first spheres
  std::vector<int> stroke_of{};  ///< of each sphere: index into `strokes`, -1 for none; empty: none for all

  /// True when `point` (map frame) lies in the closed union of the spheres.
  bool contains(const Eigen::Vector3d& point) const;

  /// The stroke of sphere `sphere`, null when it belongs to none.
  const Stroke* stroke(std::size_t sphere) const;

  /// Adds a sphere of stroke `stroke` (index into `strokes`, -1 for none) and stretches the stroke's time
  /// span.
  void add(const Sphere& sphere, double time, int stroke);
};

/// The largest radius of a ball that is painted, metres: 1,000 voxels.
constexpr double largest_painted(double resolution) { return 1000.0 * resolution; }

/// What an eraser leaves of a painted sphere: the same centre, and the radius at which the two spheres only
/// touch (rounded down). None when nothing is left. A sphere that the eraser does not reach comes back as it
/// is.
std::optional<Sphere> shrunk(const Sphere& sphere, const Sphere& eraser);

/// True when a label or part can be stored: no control characters.
bool is_storable_name(std::string_view name);

}  // namespace clearway
