#include "mapping/voxels/painted_volume.hpp"

#include <algorithm>
#include <limits>

namespace clearway {

bool PaintedVolume::contains(const Eigen::Vector3d& point) const {
  return std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
    return (point - sphere.center).squaredNorm() <= sphere.radius * sphere.radius;
  });
}

const Stroke* PaintedVolume::stroke(std::size_t sphere) const {
  if (sphere >= stroke_of.size() || stroke_of[sphere] < 0) return nullptr;
  return &strokes[static_cast<std::size_t>(stroke_of[sphere])];
}

void PaintedVolume::add(const Sphere& sphere, double time, int stroke) {
  stroke_of.resize(spheres.size(), -1);
  if (stroke >= 0) {
    Stroke& painter = strokes[static_cast<std::size_t>(stroke)];
    const bool first = std::find(stroke_of.rbegin(), stroke_of.rend(), stroke) == stroke_of.rend();
    painter.begin = first ? time : std::min(painter.begin, time);
    painter.end = first ? time : std::max(painter.end, time);
  }
  spheres.push_back(sphere);
  times.push_back(time);
  stroke_of.push_back(stroke);
}

std::optional<Sphere> shrunk(const Sphere& sphere, const Sphere& eraser) {
  const double distance = (sphere.center - eraser.center).norm();
  if (distance >= sphere.radius + eraser.radius) return sphere;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double largest = std::max(sphere.center.cwiseAbs().maxCoeff(), eraser.center.cwiseAbs().maxCoeff());
  const double radius = distance - eraser.radius - 16.0 * epsilon * (largest + distance + eraser.radius);
  if (!(radius > 0.0)) return std::nullopt;
  return Sphere{sphere.center, std::min(sphere.radius, radius)};
}

bool is_storable_name(std::string_view name) {
  return std::none_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

}  // namespace clearway
