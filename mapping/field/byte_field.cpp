#include "mapping/field/byte_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "mapping/field/blocked_field.hpp"
#include "mapping/field/byte_numbers.hpp"
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

}  // namespace

ByteField::ByteField(const BlockedField& field)
    : size(field.cells().size),
      tiles(field.distances()->tile_counts()),
      low(field.cells().first.cast<double>() * field.resolution()),
      resolution(field.resolution()),
      step(resolution / units(field)),
      outside_blocked(field.is_outside_blocked()),
      distances_(field.distances()),
      units_(units(field)),
      is_known_(std::make_unique<std::atomic<bool>[]>(tiles.cast<std::size_t>().prod())),
      memory_(zero_memory(tiles.cast<std::size_t>().prod() * DistanceTiles::tile_cells + beyond)) {
  cells = memory_;
  end = static_cast<std::uint8_t>(
      std::min(blocked + std::floor(0.5 * units_ * std::sqrt(double(distances_->cap()))), double{most}));
}

/// Leaves its memory as it found it, for the next map's.
ByteField::~ByteField() {
  if (!is_kept(memory_.size())) {
    free_zero_memory(memory_);
    return;
  }
  const auto count = tiles.cast<std::size_t>().prod();
  for (std::size_t tile = 0; tile < count; ++tile)
    if (is_known_[tile].load(std::memory_order_relaxed))
      std::memset(&memory_[tile * DistanceTiles::tile_cells], 0, DistanceTiles::tile_cells);
  keep_zero_memory(memory_);
}

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
  std::array<std::uint8_t, DistanceTiles::tile_cells> numbers;
  number_bytes(squared, numbers.size(), units_, best_instruction_set(), numbers.data());
  std::uint8_t* out = &memory_[tile * numbers.size()];
  for (std::size_t cell = 0; cell < numbers.size(); cell += sizeof(Word)) {
    Word some;
    std::memcpy(&some, &numbers[cell], sizeof some);
    std::atomic_ref(reinterpret_cast<Word&>(out[cell])).store(some, std::memory_order_relaxed);
  }
  is_known_[tile].store(true, std::memory_order_release);
}

}  // namespace clearway
