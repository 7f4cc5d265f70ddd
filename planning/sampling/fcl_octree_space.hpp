#pragma once

#include <memory>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A robot in a map as most people check it: each moved body as a shape of FCL against an fcl::OcTree of the
/// voxels that its part's policy blocks, then body against body; bodies are grown by the padding, as MoveIt
/// does. For comparison: it answers for single configurations, knows no clearance and proves no edge.
/// Immutable, safe from many threads.
class FclOctreeSpace {
 public:
  /// Takes robot, map, policies and padding from `space`; keeps no reference to it.
  explicit FclOctreeSpace(const ConfigurationSpace& space);
  ~FclOctreeSpace();
  FclOctreeSpace(FclOctreeSpace&&) noexcept;

  /// Joint limits, voxels and self-collision. Touching is not free.
  bool is_free(const Configuration& q) const;

 private:
  struct Scene;
  std::unique_ptr<const Scene> scene_;
};

}  // namespace clearway
