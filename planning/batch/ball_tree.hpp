#pragma once

// Not part of the installed library.

#include <span>
#include <vector>

namespace clearway {

/// Spheres at single precision in trees: bounds around bounds around balls. Plain data, metres.
struct BallTree {
  struct Ball {
    float x = 0, y = 0, z = 0, radius = 0;
  };
  /// A ball of a body of a robot.
  struct Leaf {
    Ball ball;
    float inner = 0;  ///< radius about its middle that lies in the body, <= 0: unknown
    int body = 0;     ///< of the robot
    int member = -1;  ///< which of the bodies that the map can block; -1: none of them
  };
  /// A sphere around other nodes, first to last - 1 of `nodes`, or around so many of `leaves`.
  struct Node {
    Ball bound;
    int first = 0, last = 0;
    bool holds_leaves = true;
    int body = -1;  ///< of all leaves in it; -1: not the same
    int core = 0;   ///< of the leaves in it the one with the largest inner sphere
    int count() const { return last - first; }
  };

  std::vector<Node> nodes;
  std::vector<Leaf> leaves;

  /// Adds a tree around these; returns its root.
  int add(std::vector<Leaf> balls);

 private:
  void fill(int node, std::span<Leaf> balls);
  int core_of(const Node& node) const;
};

/// A sphere around spheres; its radius is below 0 when there is none.
BallTree::Ball sphere_around(std::span<const BallTree::Ball> balls);

}  // namespace clearway
