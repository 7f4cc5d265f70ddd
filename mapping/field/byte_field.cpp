#include "mapping/field/byte_field.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "mapping/field/blocked_field.hpp"
#include "mapping/field/zero_memory.hpp"

namespace clearway {
namespace {

constexpr int most = 255, blocked = 1;
constexpr std::size_t beyond = 3;  ///< bytes after the last cell

// The shape that ByteField::index, and look-ups of many points like it, take a tile to have.
static_assert(DistanceTiles::nx == 32 && DistanceTiles::ny == 8 && DistanceTiles::nz == 8);

/// Units a voxel: as many as a byte has room for, up to the largest distance that the field knows.
int units(const BlockedField& field) {
  const double voxels = 0.5 * std::sqrt(double(field.distances()->cap()));
  return std::clamp(static_cast<int>((most - blocked) / voxels), 2, 16);
}

/// The number of each squared distance in half voxels, up to `cap`.
std::vector<std::uint8_t> numbers_of(int cap, int units) {
  std::vector<std::uint8_t> numbers;
  numbers.reserve(static_cast<std::size_t>(cap) + 1);
  for (int squared = 0; squared <= cap; ++squared) {  // whole numbers have whole roots: nothing is rounded up
    const double number = blocked + std::floor(0.5 * units * std::sqrt(double(squared)));
    numbers.push_back(static_cast<std::uint8_t>(std::min(number, double{most})));
  }
  return numbers;
}

}  // namespace

ByteField::ByteField(const BlockedField& field)
    : size(field.cells().size),
      tiles(field.distances()->tile_counts()),
      low(field.cells().first.cast<double>() * field.resolution()),
      resolution(field.resolution()),
      step(resolution / units(field)),
      outside_blocked(field.is_outside_blocked()),
      distances_(field.distances()),
      numbers_(numbers_of(distances_->cap(), units(field))),
      memory_(zero_memory(tiles.cast<std::size_t>().prod() * DistanceTiles::tile_cells + beyond)),
      is_known_(std::make_unique<std::atomic<bool>[]>(tiles.cast<std::size_t>().prod())) {
  cells = memory_;
  end = numbers_.back();
}

ByteField::~ByteField() { free_zero_memory(memory_); }

void ByteField::know(std::size_t cell) const {
  const std::size_t tile = cell / DistanceTiles::tile_cells;
  if (!is_known_[tile].load(std::memory_order_acquire)) make(tile);
}

/// Others may be reading: each byte is written once, whole.
void ByteField::make(std::size_t tile) const {
  using Word = std::uint64_t;
  const std::lock_guard lock(making_);
  if (is_known_[tile].load(std::memory_order_relaxed)) return;
  const Eigen::Vector3i first = distances_->box_of(distances_->place(tile)).low;
  const std::uint16_t* squared = distances_->line(first.x() >> 5, first.y(), first.z());
  std::uint8_t* out = &memory_[tile * DistanceTiles::tile_cells];
  for (std::size_t cell = 0; cell < DistanceTiles::tile_cells; cell += sizeof(Word)) {
    std::array<std::uint8_t, sizeof(Word)> some;
    for (std::size_t i = 0; i < some.size(); ++i) some[i] = numbers_[squared[cell + i]];
    std::atomic_ref(reinterpret_cast<Word&>(out[cell]))
        .store(std::bit_cast<Word>(some), std::memory_order_relaxed);
  }
  is_known_[tile].store(true, std::memory_order_release);
}

}  // namespace clearway
