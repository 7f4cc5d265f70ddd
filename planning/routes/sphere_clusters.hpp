#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// Painted spheres, those that lie close together as one: a hand that paints at 60 Hz leaves tens of
/// thousands, each of which overlaps thousands. Up to `most` spheres each is its own cluster. Beyond, a
/// cluster is made of spheres of one size, within a factor of two, whose centres share a cell; cells are
/// doubled until there are at most so many clusters, or two spheres of a cluster might not overlap any more.
/// Clusters are numbered by their first spheres.
class SphereClusters {
 public:
  /// @param is_stopped asked now and then; once true there are no clusters.
  SphereClusters(const std::vector<Sphere>& spheres, std::size_t most,
                 const std::function<bool()>& is_stopped);

  std::size_t size() const { return largest_.size(); }
  /// The largest sphere of a cluster, of equals the first.
  const Sphere& sphere(std::size_t i) const { return largest_[i]; }
  std::span<const Sphere> spheres(std::size_t i) const {
    return std::span(spheres_).subspan(first_[i], first_[i + 1] - first_[i]);
  }
  /// No sphere of it lies, with any point, farther from the largest sphere's centre.
  double reach(std::size_t i) const { return reach_[i]; }

  /// The pairs (i, j), i != j, that lie near enough to each other that some of their spheres may overlap,
  /// each once in both orders; not in order.
  void visit_near_pairs(const std::function<void(std::size_t, std::size_t)>& visit,
                        const std::function<bool()>& is_stopped) const;

 private:
  std::vector<Sphere> spheres_;     ///< cluster after cluster
  std::vector<std::size_t> first_;  ///< of each cluster, and behind the last
  std::vector<Sphere> largest_;
  std::vector<double> reach_;
};

}  // namespace clearway
