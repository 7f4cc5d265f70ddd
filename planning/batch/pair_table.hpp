#pragma once

// Not part of the installed library.

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "planning/robot/self_collision.hpp"

namespace clearway {

/// Bodies of two links that one or two joints alone move against each other, and for each small cell of the
/// values of these joints whether the bodies are proved apart everywhere in it, or some of them are proved to
/// overlap. Links next but one are near each other at all times: spheres around them cannot prove what this
/// can. Filled in as it is asked, from coarse to fine; what a cell says never depends on who asked before.
/// Safe from many threads.
class PairTable {
 public:
  /// Null when more than two joints, none, or one without limits move the bodies against each other.
  /// @param robot must outlive the table. @param pairs of its bodies, all of the same two links
  static std::shared_ptr<const PairTable> of(const Robot& robot, std::vector<BodyPair> pairs);

  /// What is proved of a cell: that all pairs are apart, by some tenth of a millimetre; that some pair
  /// overlaps, as deep; or neither. Unknown: nobody asked yet.
  enum class Proof : std::uint8_t { unknown, apart, overlap, none };

  /// Of the cell that holds the values of the joints; none for values outside the limits.
  Proof proof(const std::array<double, 2>& values) const;

  /// True when all pairs are proved to be apart everywhere between these values, which are the lower and
  /// upper ones of each joint; false where that is too many cells to look at.
  bool is_apart(const std::array<double, 2>& lower, const std::array<double, 2>& upper) const;

  /// The cells, for who looks up many side by side: those of one value of the first joint stand together. A
  /// proof that is unknown is found by proof().
  struct Cells {
    std::array<double, 2> lower,
        per_unit;  ///< of each joint: where its cells begin, how many each rad or m has
    std::array<int, 2> counts;
    const std::atomic<Proof>* proofs;  ///< and three more bytes, as registers read four
  };
  Cells cells() const { return {lower_, per_unit_, cells_, levels_.back().proofs.data()}; }

  /// The joints; the second is -1 when there is only one.
  const std::array<int, 2>& joints() const { return joints_; }

 private:
  using Cell = std::array<int, 2>;
  static constexpr std::array<int, 3> block_shifts{4, 2,
                                                   0};  ///< blocks of 16, 4 and 1 cells along each joint
  struct Level {
    int shift = 0;                    ///< a block's edge is 1 << shift cells
    std::array<int, 2> counts{1, 1};  ///< of blocks
    mutable std::vector<std::atomic<Proof>> proofs;

    Cell block_of(const Cell& cell) const { return {cell[0] >> shift, cell[1] >> shift}; }
  };

  PairTable(const Robot& robot, std::vector<BodyPair> pairs, const std::array<int, 2>& joints);
  /// The cells that hold the values; false where some are outside the limits.
  bool cells_between(const std::array<double, 2>& lower, const std::array<double, 2>& upper, Cell& first,
                     Cell& last) const;
  Proof proof_of(const Cell& cell) const;
  bool is_block_apart(const Level& level, const Cell& block) const;
  Proof prove(const Level& level, const Cell& block) const;
  /// How far the joints move from the middle of a block to its border, at most.
  Eigen::VectorXd half_of(const Level& level, const Cell& block) const;
  bool is_overlapping(const LinkPoses& poses) const;
  void make_cores() const;

  const Robot& robot_;
  std::vector<BodyPair> pairs_;
  std::array<int, 2> joints_;
  std::array<double, 2> lower_{}, width_{1.0, 1.0};  ///< of the first cell, of a cell
  std::array<double, 2> per_unit_{1.0, 1.0};         ///< cells
  std::array<int, 2> cells_{1, 1};
  std::vector<Level> levels_;
  mutable std::once_flag made_cores_;
  mutable std::vector<std::pair<Body, Body>> cores_;  ///< smaller bodies that overlap only if a pair does
};

}  // namespace clearway
