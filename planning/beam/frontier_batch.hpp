#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "planning/beam/beam_lattice.hpp"

namespace clearway {

/// A batch of the frontier: up to 64 heads of a beam whose neighbours are enumerated together: joint by
/// joint, each index that is next to that of some head, with the heads that it is next to as bits of a word.
/// Neighbours that heads share, as most are where the beam is narrow, are then met once.
class FrontierBatch {
 public:
  static constexpr std::size_t most = 64;

  /// An index of a joint that is next to that of at least one head.
  struct Choice {
    double term;          ///< Lattice::distance_term
    std::uint64_t hash;   ///< NodeSet::hash_term
    std::uint64_t heads;  ///< next to it
    int index;
  };

  /// Forgets the heads. Memory is kept.
  void clear();
  /// Needs room: size() < most.
  void add(const LatticeIndex& node, const Lattice& lattice);
  /// To be called when all heads are there.
  void finish();

  std::size_t size() const { return size_; }
  std::uint64_t all() const { return size_ == most ? ~std::uint64_t{0} : (std::uint64_t{1} << size_) - 1; }
  /// Of a joint, those nearest to the goal first.
  const std::vector<Choice>& choices(std::size_t joint) const { return choices_[joint]; }

  /// Squared distances to the goal of the nearest and the farthest neighbour of all, as the lattice's own.
  double nearest() const { return nearest_; }
  double farthest() const { return farthest_; }

  /// The least that the terms of the joints from this one on (1 or more) can add for any head, but for
  /// rounding.
  double least_rest(std::size_t joint) const { return bounds_[joint].least.front().sum; }
  /// The heads for which these joints can add at most so much, or at least so much.
  std::uint64_t that_can_add_at_most(double sum, std::size_t joint) const;
  std::uint64_t that_can_add_at_least(double sum, std::size_t joint) const;

 private:
  /// A sum, and the heads whose own is not beyond it.
  struct Bound {
    double sum;
    std::uint64_t heads;
  };
  /// The least sums ascending, the greatest descending.
  struct Bounds {
    std::vector<Bound> least, most;
  };

  std::size_t size_ = 0;
  double nearest_ = 0.0, farthest_ = 0.0;
  std::vector<std::vector<Choice>> choices_;      ///< by joint
  std::vector<Bounds> bounds_;                    ///< from joint 1 on, and behind the last
  std::vector<std::pair<double, double>> terms_;  ///< of the head being added: by joint, least and most
};

}  // namespace clearway
