#pragma once

#include <cstdint>
#include <queue>
#include <vector>

#include "planning/beam_lattice.hpp"

namespace clearway {

/// A neighbour of a head, not yet filtered.
struct Neighbour {
  double squared_distance = 0.0;  ///< of eq. 10
  int head = 0;                   ///< the number under which the head was added
  LatticeIndex node;
};

/// All 3^n neighbours of several heads in the order of their distance to the goal, each generated only when
/// asked for. The distance is a sum of one term per joint, so each head's neighbours form a heap-ordered tree
/// over the joints' choices (nearest, middle, farthest); sums in floating point keep that order.
class NeighbourQueue {
 public:
  explicit NeighbourQueue(const Lattice& lattice) : lattice_(&lattice) {}

  void add_head(int head, const LatticeIndex& node);
  bool empty() const { return heap_.empty(); }
  double next_squared_distance() const { return heap_.top().squared_distance; }
  /// The nearest neighbour left; equal distances in no particular order.
  Neighbour pop();

 private:
  struct Entry {
    double squared_distance;
    std::uint32_t head;   ///< in heads_
    std::uint64_t ranks;  ///< two bits per joint: 0 nearest, 1, 2 farthest
    int last;             ///< last joint with a rank > 0 (0 when none): successors change joints >= last
    bool operator<(const Entry& other) const { return squared_distance > other.squared_distance; }
  };
  struct Choices {
    int head;
    LatticeIndex node;
    std::vector<int> change;   ///< 3 per joint, in order of rank: -1, 0 or +1
    std::vector<double> term;  ///< 3 per joint: distance_term
  };
  void push(std::uint32_t head, std::uint64_t ranks, int last);

  const Lattice* lattice_;
  std::vector<Choices> heads_;
  std::priority_queue<Entry> heap_;
};

}  // namespace clearway
