#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/routes/sphere_clusters.hpp"

namespace clearway {

/// A way for the middle of a hand through free space, map frame, metres.
struct EndEffectorRoute {
  std::vector<Eigen::Vector3d> points;  ///< from the start hand to the goal hand; empty: there is none
  std::vector<double> radii;            ///< about each point, how far a via region reaches
};

/// What a metre of a route costs at a point, >= 1.
using RoutePrice = std::function<double(const Eigen::Vector3d&)>;

/// The painted spheres of some volumes as a graph: spheres that overlap are neighbours. The strokes of
/// whoever painted are ways through it. Its nodes are spheres; of more than most_spheres, clusters of spheres
/// that overlap (`SphereClusters`), of which `sphere` is the largest, so that an hour of painting makes no
/// larger a graph than a minute along the same way.
class PaintedGraph {
 public:
  static constexpr std::size_t most_spheres = 1024;

  /// @param volumes  bit i: volume i counts.
  /// @param passage  metres: two spheres are neighbours when the circle in which they meet has at least this
  ///                 radius (or one lies inside the other); 0: when they overlap at all.
  /// @param is_stopped asked now and then; once true the graph is empty.
  PaintedGraph(const Snapshot& map, std::uint16_t volumes, double passage,
               const std::function<bool()>& is_stopped = nullptr);

  std::size_t size() const { return neighbours_.size(); }
  const Sphere& sphere(std::size_t i) const { return clusters_.sphere(i); }
  /// Nodes that have a sphere that is a neighbour of one of node i, ascending.
  const std::vector<int>& neighbours(std::size_t i) const { return neighbours_[i]; }
  /// Number of the connected piece that node i belongs to; pieces are numbered by their first spheres.
  int piece(std::size_t i) const { return pieces_[i]; }
  int piece_count() const { return piece_count_; }

  /// The nodes that hold `point`, the deepest first; empty when none does.
  std::vector<int> holding(const Eigen::Vector3d& point) const;

  /// The cheapest way from `from` to `to` along centres of neighbouring nodes (Dijkstra; equal prices: the
  /// lower index); `price(point)` is what a metre costs where two neighbours meet. Both points must lie in
  /// spheres of one piece, else the route is empty.
  EndEffectorRoute route(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                         const RoutePrice& price) const;

 private:
  void connect(double passage, const std::function<bool()>& is_stopped);
  void number_pieces();

  SphereClusters clusters_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<int> pieces_;
  int piece_count_ = 0;
};

}  // namespace clearway
