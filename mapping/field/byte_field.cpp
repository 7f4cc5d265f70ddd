#include "mapping/field/byte_field.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "mapping/field/blocked_field.hpp"

namespace clearway {
namespace {

constexpr int most = 255;

/// Units a voxel: as many as a byte has room for, up to the largest distance that the field knows.
int units(const BlockedField& field) {
  const double voxels = 0.5 * std::sqrt(double(field.layers().cap()));
  return std::clamp(static_cast<int>(most / voxels), 2, 16);
}

/// The number of each squared distance in half voxels, up to `cap`.
std::vector<std::uint8_t> numbers_of(int cap, int units) {
  std::vector<std::uint8_t> numbers;
  for (int squared = 0; squared <= cap; ++squared) {  // whole numbers have whole roots: nothing is rounded up
    const double number = std::floor(0.5 * units * std::sqrt(double(squared)));
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
      cells(size.cast<std::size_t>().prod() + 3, 0),
      end(0) {
  const DistanceLayers& layers = field.layers();
  const std::vector<std::uint8_t> numbers = numbers_of(layers.cap(), units(field));
  end = numbers.back();
  std::uint8_t* out = cells.data();
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); x += lane_cells) {
        const std::span squared(layers.line(x >> 5, y, z),
                                static_cast<std::size_t>(std::min(lane_cells, size.x() - x)));
        for (const std::uint16_t cell : squared) *out++ = numbers[cell];
      }
    }
  }
}

}  // namespace clearway
