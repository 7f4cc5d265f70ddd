#include "planning/routes/painted_route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <span>
#include <utility>

namespace clearway {
namespace {

/// Radius of the circle in which two spheres meet, squared; that of the lesser one when it lies inside the
/// other, negative when they are apart.
double passage_squared(const Sphere& a, const Sphere& b) {
  const double d = (a.center - b.center).norm();
  if (d >= a.radius + b.radius) return -1.0;
  const double lesser = std::min(a.radius, b.radius);
  if (d <= std::abs(a.radius - b.radius)) return lesser * lesser;
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2.0 * d);
  // Of two spheres whose middles lie on one side of the circle, the lesser one's equator is the narrowest
  // place.
  if (along < 0.0 || along > d) return lesser * lesser;
  return a.radius * a.radius - along * along;
}

/// Middle of the lens in which two spheres overlap.
Eigen::Vector3d meeting_point(const Sphere& a, const Sphere& b) {
  const Eigen::Vector3d way = b.center - a.center;
  const double d = way.norm();
  if (d == 0.0) return a.center;
  return a.center + std::clamp(0.5 * (d + a.radius - b.radius) / d, 0.0, 1.0) * way;
}

std::vector<Sphere> spheres_of(const Snapshot& map, std::uint16_t volumes) {
  std::vector<Sphere> all;
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    if ((volumes >> v & 1u) == 0) continue;
    const std::vector<Sphere>& spheres = map.volumes()[v].spheres;
    all.insert(all.end(), spheres.begin(), spheres.end());
  }
  return all;
}

/// The spheres that may overlap one of a cluster with that middle and reach.
std::vector<Sphere> within(std::span<const Sphere> spheres, const Eigen::Vector3d& middle, double reach) {
  std::vector<Sphere> near;
  for (const Sphere& sphere : spheres) {
    if ((sphere.center - middle).norm() < sphere.radius + reach) near.push_back(sphere);
  }
  return near;
}

/// Whether some sphere of one cluster and some sphere of the other meet in a circle that wide.
bool are_neighbours(const SphereClusters& clusters, std::size_t a, std::size_t b, double passage) {
  const double squared = passage * passage;
  if (passage_squared(clusters.sphere(a), clusters.sphere(b)) >= squared) return true;  // as a rule
  if (clusters.spheres(a).size() == 1 && clusters.spheres(b).size() == 1) return false;
  const std::vector<Sphere> near_b =
      within(clusters.spheres(a), clusters.sphere(b).center, clusters.reach(b));
  const std::vector<Sphere> near_a =
      within(clusters.spheres(b), clusters.sphere(a).center, clusters.reach(a));
  return std::any_of(near_b.begin(), near_b.end(), [&](const Sphere& one) {
    return std::any_of(near_a.begin(), near_a.end(),
                       [&](const Sphere& other) { return passage_squared(one, other) >= squared; });
  });
}

}  // namespace

PaintedGraph::PaintedGraph(const Snapshot& map, std::uint16_t volumes, double passage,
                           const std::function<bool()>& is_stopped)
    : clusters_(spheres_of(map, volumes), most_spheres, is_stopped) {
  connect(passage, is_stopped);
  number_pieces();
}

void PaintedGraph::connect(double passage, const std::function<bool()>& is_stopped) {
  neighbours_.resize(clusters_.size());
  clusters_.visit_near_pairs(
      [&](std::size_t i, std::size_t j) {
        if (are_neighbours(clusters_, i, j, passage)) neighbours_[i].push_back(static_cast<int>(j));
      },
      is_stopped);
  if (is_stopped && is_stopped()) neighbours_.clear();
  for (std::vector<int>& neighbours : neighbours_) std::sort(neighbours.begin(), neighbours.end());
}

void PaintedGraph::number_pieces() {
  pieces_.assign(size(), -1);
  for (std::size_t i = 0; i < size(); ++i) {
    if (pieces_[i] >= 0) continue;
    std::vector<int> open{static_cast<int>(i)};
    pieces_[i] = piece_count_;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (const int next : neighbours_[static_cast<std::size_t>(at)]) {
        if (int& piece = pieces_[static_cast<std::size_t>(next)]; piece < 0) {
          piece = piece_count_;
          open.push_back(next);
        }
      }
    }
    ++piece_count_;
  }
}

std::vector<int> PaintedGraph::holding(const Eigen::Vector3d& point) const {
  std::vector<std::pair<double, int>> found;
  for (std::size_t i = 0; i < size(); ++i) {
    double depth = -1.0;
    for (const Sphere& held : clusters_.spheres(i))
      depth = std::max(depth, held.radius - (point - held.center).norm());
    if (depth >= 0.0) found.emplace_back(-depth, static_cast<int>(i));
  }
  std::sort(found.begin(), found.end());
  std::vector<int> indices;
  for (const auto& [depth, i] : found) indices.push_back(i);
  return indices;
}

EndEffectorRoute PaintedGraph::route(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     const RoutePrice& price) const {
  std::vector<double> length(size(), std::numeric_limits<double>::infinity());
  std::vector<int> before(size(), -1);
  std::vector<double> last_leg(size(), -1.0);  // to the goal, for spheres that hold it
  for (const int i : holding(to)) {
    last_leg[static_cast<std::size_t>(i)] = (sphere(static_cast<std::size_t>(i)).center - to).norm();
  }
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const int i : holding(from)) {
    length[static_cast<std::size_t>(i)] = (sphere(static_cast<std::size_t>(i)).center - from).norm();
    open.emplace(length[static_cast<std::size_t>(i)], i);
  }
  double best = std::numeric_limits<double>::infinity();
  int end = -1;
  while (!open.empty() && open.top().first < best) {
    const auto [so_far, number] = open.top();
    open.pop();
    const auto i = static_cast<std::size_t>(number);
    if (so_far > length[i]) continue;
    if (last_leg[i] >= 0.0 && so_far + last_leg[i] < best) best = so_far + last_leg[i], end = number;
    for (const int next : neighbours_[i]) {
      const auto n = static_cast<std::size_t>(next);
      const double longer =
          so_far + (sphere(n).center - sphere(i).center).norm() * price(meeting_point(sphere(i), sphere(n)));
      if (longer >= length[n]) continue;
      length[n] = longer;
      before[n] = number;
      open.emplace(longer, next);
    }
  }
  EndEffectorRoute route;
  if (end < 0) return route;
  route.points.push_back(to);
  for (int i = end; i >= 0; i = before[static_cast<std::size_t>(i)]) {
    route.points.push_back(sphere(static_cast<std::size_t>(i)).center);
    route.radii.push_back(sphere(static_cast<std::size_t>(i)).radius);
  }
  route.radii.insert(route.radii.begin(), route.radii.front());
  route.points.push_back(from);
  route.radii.push_back(route.radii.back());
  std::reverse(route.points.begin(), route.points.end());
  std::reverse(route.radii.begin(), route.radii.end());
  return route;
}

}  // namespace clearway
