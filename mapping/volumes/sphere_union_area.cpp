// Surface area of a union of spheres: exact arcs on circles of latitude.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "mapping/volumes/sphere_union.hpp"

namespace clearway {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

using Arcs = std::vector<std::pair<double, double>>;

/// The spheres in order of x, so that those near one of them lie in a window.
std::vector<Sphere> sorted_by_x(std::vector<Sphere> spheres) {
  std::stable_sort(spheres.begin(), spheres.end(),
                   [](const Sphere& a, const Sphere& b) { return a.center.x() < b.center.x(); });
  return spheres;
}

/// Calls visit(index) for the other spheres that meet sphere `i`.
template <class Visit>
void visit_neighbours(const std::vector<Sphere>& spheres, std::size_t i, double largest, const Visit& visit) {
  const auto meets = [&](std::size_t j) {
    const double reach = spheres[i].radius + spheres[j].radius;
    return (spheres[i].center - spheres[j].center).squaredNorm() < reach * reach;
  };
  const double reach = spheres[i].radius + largest;
  for (std::size_t j = i; j-- > 0 && spheres[i].center.x() - spheres[j].center.x() < reach;) {
    if (meets(j)) visit(j);
  }
  for (std::size_t j = i + 1; j < spheres.size() && spheres[j].center.x() - spheres[i].center.x() < reach;
       ++j) {
    if (meets(j)) visit(j);
  }
}

/// What a neighbour covers of a sphere of radius r about the origin: { x : x . towards > level }.
struct Cap {
  double height = 0.0;  ///< component of `towards` along the poles' axis
  double across = 0.0;  ///< length of the rest
  double angle = 0.0;   ///< direction of the rest
  double level = 0.0;
};

/// Length, in radians, of what the arcs leave open of a full turn. Arcs start in [-pi, pi].
double open_angle(Arcs& arcs) {
  const std::size_t given = arcs.size();
  for (std::size_t k = 0; k < given; ++k) {  // split those that pass +-pi
    auto& [begin, end] = arcs[k];
    if (begin < -std::numbers::pi) {
      arcs.emplace_back(begin + full_turn, std::numbers::pi);
      arcs[k].first = -std::numbers::pi;
    } else if (end > std::numbers::pi) {
      arcs.emplace_back(-std::numbers::pi, end - full_turn);
      arcs[k].second = std::numbers::pi;
    }
  }
  std::sort(arcs.begin(), arcs.end());
  double covered = 0.0, reached = -std::numbers::pi;
  for (const auto& [begin, end] : arcs) {
    covered += std::max(0.0, end - std::max(begin, reached));
    reached = std::max(reached, end);
  }
  return full_turn - covered;
}

/// Open area of a sphere of radius r, midpoint rule over the height.
double open_area(double radius, const std::vector<Cap>& caps, int circles) {
  double sum = 0.0;
  Arcs arcs;
  for (int k = 0; k < circles; ++k) {
    const double height = radius * ((2.0 * k + 1.0) / circles - 1.0);
    const double circle = std::sqrt(radius * radius - height * height);
    arcs.clear();
    bool covered = false;
    for (const Cap& cap : caps) {
      const double needed = cap.level - height * cap.height;  // circle * across * cos(theta - angle) > needed
      const double most = circle * cap.across;
      if (needed >= most) continue;
      covered = needed < -most;
      if (covered) break;
      const double half = std::acos(std::clamp(needed / most, -1.0, 1.0));
      arcs.emplace_back(cap.angle - half, cap.angle + half);
    }
    if (!covered) sum += open_angle(arcs);
  }
  return radius * sum * (2.0 * radius / circles);
}

/// The caps that other spheres cover; false when the sphere lies in another one (of two equal spheres the
/// first stays). The poles' axis is across the direction to the nearest neighbour: along a stroke no circle
/// of latitude is then parallel to the edge of a cap, where the open angle would jump.
bool find_caps(const std::vector<Sphere>& spheres, std::size_t i, double largest, std::vector<Cap>& caps) {
  caps.clear();
  const Sphere& sphere = spheres[i];
  std::vector<std::size_t> others;
  bool inside = false;
  Eigen::Vector3d nearest = Eigen::Vector3d::Constant(HUGE_VAL);
  visit_neighbours(spheres, i, largest, [&](std::size_t j) {
    const Eigen::Vector3d towards = spheres[j].center - sphere.center;
    const double distance = towards.norm();
    if (distance + sphere.radius <= spheres[j].radius) {
      inside = inside || j < i || distance > 0.0 || spheres[j].radius > sphere.radius;
    }
    if (distance + spheres[j].radius <= sphere.radius) return;
    others.push_back(j);
    if (distance > 0.0 && distance < nearest.norm()) nearest = towards;
  });
  if (inside) return false;
  if (others.empty()) return true;
  const Eigen::Vector3d axis = nearest.unitOrthogonal();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  for (const std::size_t j : others) {
    const Eigen::Vector3d towards = spheres[j].center - sphere.center;
    const Eigen::Vector2d across(towards.dot(u), towards.dot(v));
    const double level =
        0.5 * (sphere.radius * sphere.radius + towards.squaredNorm() - spheres[j].radius * spheres[j].radius);
    caps.push_back({towards.dot(axis), across.norm(), std::atan2(across.y(), across.x()), level});
  }
  return true;
}

}  // namespace

AreaEstimate union_area(const std::vector<Sphere>& spheres, int circles) {
  double largest = 0.0;
  for (const Sphere& sphere : spheres) {
    if (!sphere.center.allFinite() || !std::isfinite(sphere.radius) || !(sphere.radius > 0.0)) {
      throw std::invalid_argument("area of balls: expected finite centres and radii > 0 in metres");
    }
    largest = std::max(largest, sphere.radius);
  }
  if (circles < 2) {
    throw std::invalid_argument("area of balls: " + std::to_string(circles) + " circles, expected 2 or more");
  }
  const std::vector<Sphere> sorted = sorted_by_x(spheres);
  double fine = 0.0, coarse = 0.0;
  std::vector<Cap> caps;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!find_caps(sorted, i, largest, caps)) continue;
    fine += open_area(sorted[i].radius, caps, circles);
    coarse += open_area(sorted[i].radius, caps, circles / 2);
  }
  return {fine, std::abs(fine - coarse)};
}

}  // namespace clearway
