#include "planning/routes/free_route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace clearway {
namespace {

constexpr double most_cells = 4e6;
constexpr std::size_t cells_a_look = 4096;  ///< at the time

/// Cells about the whole of a box, and which of them the sphere may enter: none of those not yet looked up
/// when out of time.
class CellGrid {
 public:
  CellGrid(const BlockedSpace& space, const Eigen::AlignedBox3d& box, double radius, double cell,
           const std::function<bool()>& out_of_time)
      : origin_(box.min()), edge_(cell) {
    while ((box.sizes().array() / edge_ + 1.0).ceil().prod() > most_cells) edge_ *= 1.25;
    for (int i = 0; i < 3; ++i) size_[i] = static_cast<int>(std::floor(box.sizes()[i] / edge_)) + 1;
    const auto count = static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                       static_cast<std::size_t>(size_[2]);
    open_.assign(count, false);
    radius = std::min(radius, space.max_distance());  // the field tells no more
    std::vector<double> x, y, z, clearance;
    for (std::size_t first = 0; first < count && !out_of_time(); first += cells_a_look) {
      const std::size_t end = std::min(first + cells_a_look, count);
      x.clear(), y.clear(), z.clear();
      for (std::size_t i = first; i < end; ++i) {
        const Eigen::Vector3d at = center(static_cast<int>(i));
        x.push_back(at.x()), y.push_back(at.y()), z.push_back(at.z());
      }
      clearance.resize(end - first);
      space.clearances({x, y, z}, clearance);
      for (std::size_t i = first; i < end; ++i)
        open_[i] = clearance[i - first] > 0.0 && clearance[i - first] >= radius;
    }
  }

  std::size_t count() const { return open_.size(); }
  double edge() const { return edge_; }
  bool is_open(int cell) const { return open_[static_cast<std::size_t>(cell)]; }
  Eigen::Vector3d center(int cell) const {
    const int x = cell % size_[0], y = cell / size_[0] % size_[1], z = cell / size_[0] / size_[1];
    return origin_ + edge_ * Eigen::Vector3d(x, y, z);
  }
  /// The open cell nearest to the point within two cells of it; -1 when none is.
  int open_near(const Eigen::Vector3d& point) const {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    visit_about(point, [&](int cell) {
      const double distance = (center(cell) - point).squaredNorm();
      if (is_open(cell) && distance < least) best = cell, least = distance;
    });
    return best;
  }
  template <typename Visit>
  void visit_neighbours(int cell, Visit visit) const {
    const int x = cell % size_[0], y = cell / size_[0] % size_[1], z = cell / size_[0] / size_[1];
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if ((dx == 0 && dy == 0 && dz == 0) || !holds(x + dx, y + dy, z + dz)) continue;
          visit(index(x + dx, y + dy, z + dz), std::sqrt(static_cast<double>(dx * dx + dy * dy + dz * dz)));
        }
      }
    }
  }

 private:
  bool holds(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < size_[0] && y < size_[1] && z < size_[2];
  }
  int index(int x, int y, int z) const { return (z * size_[1] + y) * size_[0] + x; }
  template <typename Visit>
  void visit_about(const Eigen::Vector3d& point, Visit visit) const {
    const Eigen::Vector3d at = ((point - origin_) / edge_).array().round().max(-1e6).min(1e6);
    for (int dz = -2; dz <= 2; ++dz) {
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int x = static_cast<int>(at.x()) + dx, y = static_cast<int>(at.y()) + dy,
                    z = static_cast<int>(at.z()) + dz;
          if (holds(x, y, z)) visit(index(x, y, z));
        }
      }
    }
  }

  Eigen::Vector3d origin_;
  double edge_;
  int size_[3] = {1, 1, 1};
  std::vector<bool> open_;
};

}  // namespace

EndEffectorRoute free_route(const BlockedSpace& space, const Eigen::AlignedBox3d& bounds,
                            const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                            double cell, const RoutePrice& price, const std::function<bool()>& out_of_time) {
  EndEffectorRoute route;
  if (bounds.isEmpty() || !from.allFinite() || !to.allFinite()) return route;
  const CellGrid grid(space, bounds, radius, cell, out_of_time);
  const int first = grid.open_near(from), last = grid.open_near(to);
  if (first < 0 || last < 0) return route;

  std::vector<double> length(grid.count(), std::numeric_limits<double>::infinity());
  std::vector<int> before(grid.count(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const Eigen::Vector3d target = grid.center(last);
  const auto ahead = [&](int at) { return (grid.center(at) - target).norm() / grid.edge(); };  // A*
  length[static_cast<std::size_t>(first)] = 0.0;
  open.emplace(ahead(first), first);
  for (std::size_t looked = 0; !open.empty() && open.top().second != last; ++looked) {
    if (looked % 1024 == 0 && out_of_time()) return route;
    const auto [sum, at] = open.top();
    open.pop();
    const double so_far = length[static_cast<std::size_t>(at)];
    if (sum > so_far + ahead(at)) continue;
    grid.visit_neighbours(at, [&, at = at](int next, double step) {
      if (!grid.is_open(next)) return;
      const double longer = so_far + step * price(grid.center(next));
      if (longer >= length[static_cast<std::size_t>(next)]) return;
      length[static_cast<std::size_t>(next)] = longer;
      before[static_cast<std::size_t>(next)] = at;
      open.emplace(longer + ahead(next), next);
    });
  }
  if (open.empty()) return route;
  route.points.push_back(to);
  for (int i = last; i >= 0; i = before[static_cast<std::size_t>(i)]) route.points.push_back(grid.center(i));
  route.points.push_back(from);
  std::reverse(route.points.begin(), route.points.end());
  route.radii.assign(route.points.size(), 2.0 * std::max(radius, grid.edge()));
  return route;
}

}  // namespace clearway
