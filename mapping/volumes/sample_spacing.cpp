// How densely a stroke was sampled.

#include <algorithm>
#include <cmath>

#include "mapping/volumes/volume_quality.hpp"

namespace clearway {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Where two spheres meet: `radius` of their circle, and how far along from a to b its plane lies.
struct Circle {
  double along = 0.0, radius = 0.0;
};

Circle circle_between(const Sphere& a, const Sphere& b, double distance) {
  const double gap = distance - a.radius - b.radius;
  if (gap >= 0.0) return {a.radius + 0.5 * gap, 0.0};
  const double along = 0.5 * (distance + (a.radius * a.radius - b.radius * b.radius) / distance);
  return {along, std::sqrt(std::max(a.radius * a.radius - along * along, 0.0))};
}

}  // namespace

SampleSpacing sample_spacing(const std::vector<Sphere>& spheres) {
  SampleSpacing spacing;
  std::vector<double> distances, relative;
  for (std::size_t i = 1; i < spheres.size(); ++i) {
    const Sphere& a = spheres[i - 1];
    const Sphere& b = spheres[i];
    const double smaller = std::min(a.radius, b.radius);
    const double distance = (b.center - a.center).norm();
    distances.push_back(distance);
    relative.push_back(distance / smaller);
    if (distance + smaller <= std::max(a.radius, b.radius)) continue;  // one lies in the other
    const Circle circle = circle_between(a, b, distance);
    // A smaller sphere whose centre the plane lies beyond shows its full width.
    const bool full_width = circle.along < 0.0 || circle.along > distance;
    if (full_width || circle.radius >= 0.5 * smaller) continue;
    spacing.thin.push_back(
        {i, a.center + (b.center - a.center) * (circle.along / distance), distance, circle.radius});
  }
  if (distances.empty()) return spacing;
  spacing.largest = *std::max_element(distances.begin(), distances.end());
  spacing.largest_relative = *std::max_element(relative.begin(), relative.end());
  spacing.median = median(distances);
  spacing.median_relative = median(relative);
  return spacing;
}

}  // namespace clearway
