#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "planning/beam/beam_lattice.hpp"
#include "planning/beam/blocked_nodes.hpp"
#include "planning/beam/frontier_batch.hpp"

namespace clearway {

/// A neighbour of one head or several, not yet filtered.
struct Neighbour {
  double squared_distance = 0.0;  ///< of Chong 2008, eq. 10
  LatticeIndex node;
  std::vector<int> heads;  ///< the numbers under which they were added, ascending
};

/// All 3^n neighbours of several heads in the order of their distance to the goal, each generated only when
/// asked for. The distance is a sum of one term per joint, so those within a band of distances are found by
/// adding terms joint by joint and leaving off what cannot end within it; band after band. Sums in floating
/// point, in joint order as Lattice::squared_distance, keep that order. Nodes that are closed when their band
/// is begun are left off, as soon as the joints that close them are chosen.
class NeighbourQueue {
 public:
  /// @param band how far the first band goes beyond the nearest neighbour, as squared distance; 0: a guess.
  /// @param closed null: nothing is. Outlives the queue.
  /// @param is_stopped asked now and then while neighbours are enumerated, which may be many at one distance;
  /// once true, what comes out of the queue may be anything.
  explicit NeighbourQueue(const Lattice& lattice, double band = 0.0, const BlockedNodes* closed = nullptr,
                          std::function<bool()> is_stopped = nullptr)
      : lattice_(&lattice), closed_(closed), is_stopped_(std::move(is_stopped)), band_(band) {}

  /// Forgets the heads, as new. Memory is kept.
  void restart(double band);

  /// All heads are added before the first question.
  void add_head(int head, const LatticeIndex& node);
  bool empty();
  double next_squared_distance();
  /// The nearest neighbour left with all heads that it is a neighbour of; equal distances in a fixed order.
  void pop(Neighbour& neighbour);
  Neighbour pop();
  /// Neighbours popped so far, each counted for every head.
  std::uint64_t popped() const { return popped_; }
  /// How far beyond the nearest neighbour the last one popped was: a good band for heads close by.
  double band() const { return last_ - least_; }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// A node, and the heads that it is a neighbour of as a list in ways_.
  struct Entry {
    double squared_distance;
    std::uint64_t hash;  ///< of the node
    std::uint32_t node;  ///< place in nodes_, in nodes
    std::uint32_t first_way, last_way;
  };
  struct Way {
    std::uint64_t heads;  ///< of its group
    std::uint32_t group;
    std::uint32_t next;  ///< in ways_, or none
  };
  void begin();
  void fill();
  void widen();
  void sort_entries();
  bool enumerate_band();
  void enumerate(std::size_t joint, double sum, std::uint64_t hash, std::uint64_t heads);
  bool is_node_of(const Entry& entry) const;
  void add_way(double sum, std::uint64_t hash, std::uint64_t heads);
  void grow_slots();

  const Lattice* lattice_;
  const BlockedNodes* closed_;
  std::function<bool()> is_stopped_;
  std::vector<int> numbers_;           ///< of the heads, group after group
  std::vector<FrontierBatch> groups_;  ///< the first group_count_
  std::size_t group_count_ = 0, joints_ = 0;
  std::vector<Entry> entries_;        ///< of the band, nearest first, from next_ on
  std::vector<Way> ways_;             ///< to these
  std::vector<int> nodes_;            ///< of these
  std::vector<std::uint32_t> slots_;  ///< of entries_ by hash: a power of two of them, at least half none
  std::size_t next_ = 0;
  std::vector<Entry> unsorted_;             ///< and
  std::vector<std::uint32_t> bucket_ends_;  ///< memory of sort_entries
  std::vector<int> node_;                   ///< under enumeration
  std::uint32_t group_ = 0;                 ///< under enumeration
  double least_ = 0.0, most_ = 0.0;  ///< squared distance of the nearest and the farthest neighbour of all
  std::size_t most_ways_ = 0;        ///< of a band, so that it stays O(heads) (but for equal distances)
  double band_;
  double begin_ = -1.0, end_ = -1.0;  ///< squared distances of the band: beyond begin_, up to end_
  int widened_ = 0;                   ///< times
  double last_ = 0.0;
  std::uint64_t popped_ = 0, enumerated_ = 0;
  bool has_begun_ = false, was_stopped_ = false;
};

}  // namespace clearway
