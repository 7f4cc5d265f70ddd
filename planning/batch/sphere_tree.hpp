#pragma once

// Not part of the installed library.

#include <span>
#include <vector>

namespace clearway {

/// Bounding sphere hierarchies at single precision: spheres around spheres around those of the bodies. Plain
/// data, metres.
struct SphereTree {
  struct FloatSphere {
    float x = 0, y = 0, z = 0, radius = 0;
  };
  /// A sphere of a body of a robot.
  struct Leaf {
    FloatSphere sphere;
    float inner = 0;  ///< radius about its middle that lies in the body, <= 0: unknown
    int body = 0;     ///< of the robot
    int member = -1;  ///< which of the bodies that the map can block; -1: none of them
  };
  /// A sphere around other nodes, first to last - 1 of `nodes`, or around so many of `leaves`.
  struct Node {
    FloatSphere bound;
    int first = 0, last = 0;
    bool holds_leaves = true;
    int body = -1;  ///< of all leaves in it; -1: not the same
    int core = 0;   ///< of the leaves in it the one with the largest inner sphere
    int count() const { return last - first; }
  };

  std::vector<Node> nodes;
  std::vector<Leaf> leaves;

  /// Adds a tree around these; returns its root.
  int add(std::vector<Leaf> spheres);

 private:
  void fill(int node, std::span<Leaf> spheres);
  int core_of(const Node& node) const;
};

/// A sphere around spheres; its radius is below 0 when there is none.
SphereTree::FloatSphere sphere_around(std::span<const SphereTree::FloatSphere> spheres);

}  // namespace clearway
