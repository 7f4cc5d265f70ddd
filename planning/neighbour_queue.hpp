#pragma once

#include <cstdint>
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
/// asked for. The distance is a sum of one term per joint, so those within a band of distances are found by
/// adding terms joint by joint and leaving off what cannot end within it; band after band, each holding some
/// four times as many neighbours as all before. Sums in floating point, in joint order as
/// Lattice::squared_distance, keep that order.
class NeighbourQueue {
 public:
  /// @param band how far the first band goes beyond the nearest neighbour, as squared distance; 0: a guess.
  explicit NeighbourQueue(const Lattice& lattice, double band = 0.0) : lattice_(&lattice), band_(band) {}

  void add_head(int head, const LatticeIndex& node);
  bool empty();
  double next_squared_distance();
  /// The nearest neighbour left; equal distances in no particular order.
  Neighbour pop();
  void pop(Neighbour& neighbour);
  /// How far beyond the nearest neighbour the last one popped was: a good band for heads close by.
  double band() const { return popped_ - least_; }

 private:
  struct Entry {
    double squared_distance;
    std::uint32_t head;   ///< in heads_
    std::uint64_t ranks;  ///< two bits per joint: 0 nearest, 1, 2 farthest
    bool operator<(const Entry& other) const { return squared_distance > other.squared_distance; }
  };
  struct Choices {
    int head;
    LatticeIndex node;
    std::vector<int> change;         ///< 3 per joint, in order of rank: -1, 0 or +1
    std::vector<double> term;        ///< 3 per joint: distance_term
    std::vector<double> least_rest;  ///< at j: the sum of the nearest terms of joints j on
    std::vector<double> most_rest;   ///< of the farthest terms
  };
  void fill();
  void widen();
  bool enumerate_band();
  void enumerate(std::uint32_t head, std::size_t joint, double sum, std::uint64_t ranks);

  const Lattice* lattice_;
  std::vector<Choices> heads_;
  std::vector<Entry> heap_;          ///< within the band, nearest first
  double least_ = 0.0, most_ = 0.0;  ///< squared distance of the nearest and the farthest neighbour of all
  std::size_t most_entries_ = 0;     ///< of heap_, so that it stays O(heads) (but for equal distances)
  double band_;
  double begin_ = -1.0, end_ = -1.0;  ///< squared distances of the band: beyond begin_, up to end_
  double popped_ = 0.0;
};

}  // namespace clearway
