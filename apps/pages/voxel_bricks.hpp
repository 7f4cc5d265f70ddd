#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearway {

/// A set of voxels of an octree's space (65,536 an edge): bricks of 8 x 8 x 8 cells, a bit each, and cubes
/// that are as large as a brick or larger, as octrees store them. A cell is a voxel at first; coarser cells
/// are cubes of voxels, and then no smaller cube is held.
class VoxelBricks {
 public:
  using Cell = std::array<int, 3>;
  static constexpr int space = 65536;  ///< voxels along an edge

  /// z by z, in each bit 8 y + x.
  using Bits = std::array<std::uint64_t, 8>;

  /// A brick with `bits`, or a full cube. `code` is the Morton code of the lowest voxel, so that it covers
  /// the codes [code, code + 8^level) and no others.
  struct Cube {
    static constexpr std::uint32_t full = 0xffffffff;
    std::uint64_t code = 0;
    std::uint32_t bits = full;  ///< index of its bits
    std::uint8_t level = 0;     ///< its edge is 2^level voxels
  };

  /// Adds a cube of 2^level voxels an edge, aligned to its own edge. In the order of Morton codes it is
  /// fast. Precondition: cells are voxels. @throws std::invalid_argument where it overlaps what is there; may
  /// do so in sort() only.
  void add(const Cell& low, int level);
  /// Puts everything into the order of codes; the functions below ask for it.
  /// @throws std::invalid_argument when cubes overlap.
  void sort();
  /// Adds all of another set, whose cells are of the same size.
  void append(const VoxelBricks& other);

  /// Doubles the cells. @param any a cell is in the set where any of its eight is, else where all are
  void coarsen(bool any);

  int cell_level() const { return cell_level_; }  ///< a cell has 2^level voxels an edge
  std::size_t bricks() const { return bits_.size(); }
  bool empty() const { return cubes_.empty(); }
  const std::vector<Cube>& cubes() const { return cubes_; }
  const Bits& bits(const Cube& cube) const { return bits_[cube.bits]; }
  int brick_level() const { return cell_level_ + 3; }

  static std::uint64_t code_of(const Cell& low);
  static Cell low_of(std::uint64_t code);
  /// Voxels of a cube of 2^level an edge.
  static std::uint64_t volume(int level) { return std::uint64_t{1} << (3 * level); }

 private:
  Bits& brick_at(std::uint64_t code);
  void set(Bits& bits, std::uint64_t code, int level);

  std::vector<Cube> cubes_;
  std::vector<Bits> bits_;
  int cell_level_ = 0;
  bool sorted_ = true;
};

}  // namespace clearway
