#include "planning/routes/free_route.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace clearway {
namespace {

constexpr double most_cells = 4e6;
constexpr int tile_edge = 4;
constexpr std::size_t tile_cells = tile_edge * tile_edge * tile_edge;

struct RouteCell {
  double price = 0.0;                                       ///< of a metre; 0: the sphere may not enter
  double length = std::numeric_limits<double>::infinity();  ///< of the best way here, in cells
  double sum = 0.0;                                         ///< that and what is ahead at least
  int before = -1;
};

/// Cells about the whole of a box, looked up a tile at a time, where the search comes.
class CellGrid {
 public:
  CellGrid(const BlockedSpace& space, const Eigen::AlignedBox3d& box, double radius, double cell,
           const CellPrice& price)
      : space_(space), price_(price), origin_(box.min()), edge_(cell) {
    while ((box.sizes().array() / edge_ + 1.0).ceil().prod() > most_cells) edge_ *= 1.25;
    for (int i = 0; i < 3; ++i) {
      size_[i] = static_cast<int>(std::floor(box.sizes()[i] / edge_)) + 1;
      tiles_[i] = (size_[i] + tile_edge - 1) / tile_edge;
    }
    radius_ = std::min(radius, space.max_distance());  // the field knows no more
    first_cell_.assign(static_cast<std::size_t>(tiles_[0]) * static_cast<std::size_t>(tiles_[1]) *
                           static_cast<std::size_t>(tiles_[2]),
                       -1);
  }

  double edge() const { return edge_; }
  RouteCell& at(int index) {
    const Eigen::Vector3i place = place_of(index), tile = place / tile_edge,
                          inside = place - tile_edge * tile;
    int& first =
        first_cell_[static_cast<std::size_t>((tile.z() * tiles_[1] + tile.y()) * tiles_[0] + tile.x())];
    if (first < 0) first = look_up(tile);
    return cells_[static_cast<std::size_t>(first + (inside.z() * tile_edge + inside.y()) * tile_edge +
                                           inside.x())];
  }
  bool is_open(int index) { return at(index).price > 0.0; }
  Eigen::Vector3d center(int index) const { return origin_ + edge_ * place_of(index).cast<double>(); }
  /// The open cell nearest to the point within two cells of it; -1 when none is.
  int open_near(const Eigen::Vector3d& point) {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d rounded = ((point - origin_) / edge_).array().round().max(-1e6).min(1e6);
    visit_about(rounded.cast<int>(), 2, [&](int index) {
      const double distance = (center(index) - point).squaredNorm();
      if (distance < least && is_open(index)) best = index, least = distance;
    });
    return best;
  }
  template <typename Visit>
  void visit_neighbours(int index, Visit visit) const {
    const Eigen::Vector3i middle = place_of(index);
    visit_about(middle, 1, [&](int next) {
      if (next != index) visit(next, (place_of(next) - middle).cast<double>().norm());
    });
  }

 private:
  Eigen::Vector3i place_of(int index) const {
    return {index % size_[0], index / size_[0] % size_[1], index / size_[0] / size_[1]};
  }
  /// The cells within so many cells of a place, along each axis.
  template <typename Visit>
  void visit_about(const Eigen::Vector3i& place, int within, Visit visit) const {
    const Eigen::Vector3i low = (place.array() - within).max(0);
    const Eigen::Vector3i high =
        (place.array() + within).min(Eigen::Array3i(size_[0], size_[1], size_[2]) - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) visit((z * size_[1] + y) * size_[0] + x);
      }
    }
  }

  /// Makes the cells of a tile; the first one's number.
  int look_up(const Eigen::Vector3i& tile) {
    std::array<double, tile_cells> x, y, z, clearance;
    for (std::size_t i = 0; i < tile_cells; ++i) {
      const int number = static_cast<int>(i);
      const Eigen::Vector3i inside(number % tile_edge, number / tile_edge % tile_edge,
                                   number / tile_edge / tile_edge);
      const Eigen::Vector3d at = origin_ + edge_ * (tile_edge * tile + inside).cast<double>();
      x[i] = at.x(), y[i] = at.y(), z[i] = at.z();
    }
    space_.clearances({x, y, z}, clearance);
    const auto first = static_cast<int>(cells_.size());
    for (std::size_t i = 0; i < tile_cells; ++i) {
      const bool is_open = clearance[i] > 0.0 && clearance[i] >= radius_;
      cells_.push_back({.price = is_open ? price_({x[i], y[i], z[i]}, clearance[i]) : 0.0});
    }
    return first;
  }

  const BlockedSpace& space_;
  const CellPrice& price_;
  Eigen::Vector3d origin_;
  double edge_, radius_ = 0.0;
  int size_[3] = {1, 1, 1}, tiles_[3] = {1, 1, 1};
  std::vector<int> first_cell_;  ///< of each tile; -1: not looked up yet
  std::vector<RouteCell> cells_;
};

}  // namespace

EndEffectorRoute free_route(const BlockedSpace& space, const Eigen::AlignedBox3d& bounds,
                            const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                            double cell, const CellPrice& price, const std::function<bool()>& out_of_time,
                            double most_times) {
  EndEffectorRoute route;
  if (bounds.isEmpty() || !from.allFinite() || !to.allFinite()) return route;
  CellGrid grid(space, bounds, radius, cell, price);
  const int first = grid.open_near(from), last = grid.open_near(to);
  if (first < 0 || last < 0) return route;

  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const Eigen::Vector3d target = grid.center(last);
  const auto reach = [&](int at, double length, int before) {
    RouteCell& reached = grid.at(at);
    reached.length = length;
    reached.before = before;
    reached.sum = length + most_times * (grid.center(at) - target).norm() / grid.edge();
    open.emplace(reached.sum, at);
  };
  reach(first, 0.0, -1);
  for (std::size_t looked = 0; !open.empty() && open.top().second != last; ++looked) {
    if (looked % 64 == 0 && out_of_time()) return route;
    const auto [sum, at] = open.top();
    open.pop();
    if (sum > grid.at(at).sum) continue;
    const double so_far = grid.at(at).length;
    grid.visit_neighbours(at, [&, at = at](int next, double step) {
      const RouteCell& there = grid.at(next);
      if (there.price <= 0.0) return;
      const double longer = so_far + step * there.price;
      if (longer < there.length) reach(next, longer, at);
    });
  }
  if (open.empty()) return route;
  route.points.push_back(to);
  for (int i = last; i >= 0; i = grid.at(i).before) route.points.push_back(grid.center(i));
  route.points.push_back(from);
  std::reverse(route.points.begin(), route.points.end());
  route.radii.assign(route.points.size(), 2.0 * std::max(radius, grid.edge()));
  return route;
}

}  // namespace clearway
