#include "apps/pages/voxel_bricks.hpp"

#include <algorithm>
#include <stdexcept>

namespace clearway {
namespace {

std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffULL;
  x = (x | x << 16) & 0x001f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

int gathered_bits(std::uint64_t x) {
  x &= 0x1249249249249249ULL;
  x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
  x = (x | x >> 4) & 0x100f00f00f00f00fULL;
  x = (x | x >> 8) & 0x001f0000ff0000ffULL;
  x = (x | x >> 16) & 0x001f00000000ffffULL;
  return static_cast<int>((x | x >> 32) & 0xffff);
}

[[noreturn]] void refuse_overlap() { throw std::invalid_argument("overlaps another"); }

constexpr std::uint64_t even_columns = 0x0055005500550055ULL;  ///< x and y even

/// Of two slices of a brick, one above the other, the 4 x 4 cells of twice the edge: bit 8 y + x.
std::uint64_t halved(std::uint64_t low, std::uint64_t high, bool any) {
  std::uint64_t t = any ? low | high : low & high;
  t = any ? t | t >> 1 : t & (t >> 1);
  t = any ? t | t >> 8 : t & (t >> 8);
  t &= even_columns;
  std::uint64_t cells = 0;
  for (unsigned y = 0; y < 4; ++y) {
    std::uint64_t row = t >> (16 * y) & 0x55;
    row = (row | row >> 1) & 0x33;
    row = (row | row >> 2) & 0x0f;
    cells |= row << (8 * y);
  }
  return cells;
}

}  // namespace

std::uint64_t VoxelBricks::code_of(const Cell& c) {
  return spread_bits(static_cast<std::uint64_t>(c[0])) | spread_bits(static_cast<std::uint64_t>(c[1])) << 1 |
         spread_bits(static_cast<std::uint64_t>(c[2])) << 2;
}

VoxelBricks::Cell VoxelBricks::low_of(std::uint64_t code) {
  return {gathered_bits(code), gathered_bits(code >> 1), gathered_bits(code >> 2)};
}

/// The last brick, if it is the one of `code`, else a new one behind it.
VoxelBricks::Bits& VoxelBricks::brick_at(std::uint64_t code) {
  const std::uint64_t brick = code & ~(volume(brick_level()) - 1);
  if (cubes_.empty() || cubes_.back().code != brick || cubes_.back().bits == Cube::full) {
    sorted_ = sorted_ && (cubes_.empty() || cubes_.back().code + volume(cubes_.back().level) <= brick);
    cubes_.push_back(
        {brick, static_cast<std::uint32_t>(bits_.size()), static_cast<std::uint8_t>(brick_level())});
    bits_.push_back({});
  }
  return bits_[cubes_.back().bits];
}

void VoxelBricks::set(Bits& bits, std::uint64_t code, int level) {
  const Cell low = low_of(code);
  const unsigned side = 1U << level;
  const std::uint64_t row = (std::uint64_t{1} << side) - 1;
  for (unsigned z = 0; z < side; ++z) {
    std::uint64_t& slice = bits[(static_cast<unsigned>(low[2]) & 7U) + z];
    for (unsigned y = 0; y < side; ++y) {
      const unsigned at =
          8 * ((static_cast<unsigned>(low[1]) & 7U) + y) + (static_cast<unsigned>(low[0]) & 7U);
      if ((slice & row << at) != 0) refuse_overlap();
      slice |= row << at;
    }
  }
}

void VoxelBricks::add(const Cell& low, int level) {
  const std::uint64_t code = code_of(low);
  if (level < brick_level()) return set(brick_at(code), code, level);
  sorted_ = sorted_ && (cubes_.empty() || cubes_.back().code + volume(cubes_.back().level) <= code);
  cubes_.push_back({code, Cube::full, static_cast<std::uint8_t>(level)});
}

void VoxelBricks::append(const VoxelBricks& other) {
  if (other.empty()) return;
  sorted_ = sorted_ && other.sorted_ &&
            (empty() || cubes_.back().code + volume(cubes_.back().level) <= other.cubes_.front().code);
  const auto shift = static_cast<std::uint32_t>(bits_.size());
  for (Cube cube : other.cubes_) {
    if (cube.bits != Cube::full) cube.bits += shift;
    cubes_.push_back(cube);
  }
  bits_.insert(bits_.end(), other.bits_.begin(), other.bits_.end());
}

void VoxelBricks::sort() {
  if (sorted_) return;
  std::stable_sort(cubes_.begin(), cubes_.end(),
                   [](const Cube& a, const Cube& b) { return a.code < b.code; });
  std::size_t kept = 0;
  for (const Cube& cube : cubes_) {
    if (kept > 0 && cube.code < cubes_[kept - 1].code + volume(cubes_[kept - 1].level)) {
      const Cube& before = cubes_[kept - 1];
      if (before.bits == Cube::full || cube.bits == Cube::full) refuse_overlap();
      for (std::size_t z = 0; z < 8; ++z) {
        if ((bits_[before.bits][z] & bits_[cube.bits][z]) != 0) refuse_overlap();
        bits_[before.bits][z] |= bits_[cube.bits][z];
      }
      continue;
    }
    cubes_[kept++] = cube;
  }
  cubes_.resize(kept);
  sorted_ = true;
}

void VoxelBricks::coarsen(bool any) {
  VoxelBricks coarse;
  coarse.cell_level_ = cell_level_ + 1;
  const Bits all{~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL};
  for (const Cube& cube : cubes_) {
    if (cube.level > brick_level()) {
      coarse.cubes_.push_back(cube);
      continue;
    }
    const Bits& fine = cube.bits == Cube::full ? all : bits_[cube.bits];
    const auto octant = static_cast<unsigned>(cube.code >> (3 * brick_level()) & 7U);
    const unsigned shift = (octant & 1U ? 4 : 0) + (octant & 2U ? 32 : 0);
    Bits reduced{};
    std::uint64_t some = 0;
    for (std::size_t z = 0; z < 4; ++z) some |= reduced[z] = halved(fine[2 * z], fine[2 * z + 1], any);
    if (some == 0) continue;
    Bits& brick = coarse.brick_at(cube.code);
    for (std::size_t z = 0; z < 4; ++z) brick[z + (octant & 4U ? 4 : 0)] |= reduced[z] << shift;
  }
  *this = std::move(coarse);
}

}  // namespace clearway
