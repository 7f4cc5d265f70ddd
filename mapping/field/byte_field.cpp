#include "mapping/field/byte_field.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/field/blocked_field.hpp"
#include "mapping/field/zero_memory.hpp"

namespace clearway {
namespace {

constexpr int most = 255, blocked = 1;
constexpr std::size_t beyond = 3;  ///< bytes after the last cell

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
      low(field.cells().first.cast<double>() * field.resolution()),
      resolution(field.resolution()),
      step(resolution / units(field)),
      outside_blocked(field.is_outside_blocked()),
      distances_(field.distances()),
      numbers_(numbers_of(distances_->cap(), units(field))),
      memory_(zero_memory(size.cast<std::size_t>().prod() + beyond)),
      is_known_(std::make_unique<std::atomic<bool>[]>(distances_->tile_counts().cast<std::size_t>().prod())) {
  cells = memory_;
  end = numbers_.back();
}

ByteField::~ByteField() { free_zero_memory(memory_); }

void ByteField::know(std::size_t cell) const {
  const auto nx = static_cast<std::size_t>(size.x()), ny = static_cast<std::size_t>(size.y());
  const auto x = static_cast<int>(cell % nx), y = static_cast<int>(cell / nx % ny);
  const std::size_t tile = distances_->tile(x >> 5, y, static_cast<int>(cell / nx / ny));
  if (!is_known_[tile].load(std::memory_order_acquire)) make(tile);
}

void ByteField::make(std::size_t tile) const {
  const std::lock_guard lock(making_);
  if (is_known_[tile].load(std::memory_order_relaxed)) return;
  const DistanceTiles::Box box = distances_->box_of(distances_->place(tile));
  for (int z = box.low.z(); z < box.high.z(); ++z) {
    for (int y = box.low.y(); y < box.high.y(); ++y) {
      const std::uint16_t* squared = distances_->line(box.low.x() >> 5, y, z);
      const auto row =
          static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y()) + static_cast<std::size_t>(y);
      std::uint8_t* out =
          &memory_[row * static_cast<std::size_t>(size.x()) + static_cast<std::size_t>(box.low.x())];
      for (int i = 0; i < box.high.x() - box.low.x(); ++i)  // others may be reading: each byte once, whole
        std::atomic_ref(out[i]).store(numbers_[squared[i]], std::memory_order_relaxed);
    }
  }
  is_known_[tile].store(true, std::memory_order_release);
}

}  // namespace clearway
