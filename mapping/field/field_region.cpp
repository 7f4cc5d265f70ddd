#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "mapping/field/blocked_field.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr double farthest_cell = 1 << 28;
constexpr double cube_cells = 8.0;  ///< along an edge

constexpr double cells_of_a_tile = double{DistanceTiles::tile_cells};

/// Bytes that a tile of cells takes: its distances, its place among the tiles, its bits; and its bytes.
constexpr double bytes_of_a_tile = 2.0 * cells_of_a_tile + 56.0 + cells_of_a_tile / 8.0;
constexpr double bytes_of_all_of_a_tile = bytes_of_a_tile + cells_of_a_tile;

double tiles_of(const Eigen::Array3d& size) {
  return (size / Eigen::Array3d(DistanceTiles::nx, DistanceTiles::ny, DistanceTiles::nz)).ceil().prod();
}

[[noreturn]] void refuse_size(const Eigen::Vector3d& size, double bytes, double resolution,
                              std::size_t limit) {
  const double cells = std::cbrt(static_cast<double>(limit) * cells_of_a_tile / bytes_of_a_tile);
  const double edge = std::max(1.0, std::floor(cells) - DistanceTiles::nx) * resolution;
  const auto text = [](double value) {
    std::string digits = std::to_string(value);
    return digits.substr(0, digits.find('.') + 3);
  };
  throw std::invalid_argument("region of " + text(size.x()) + " x " + text(size.y()) + " x " +
                              text(size.z()) + " m needs " + text(bytes / (1U << 20U)) +
                              " MiB at a resolution of " + text(resolution * 1000.0) +
                              " mm, more than the limit of " + std::to_string(limit >> 20U) +
                              " MiB: a cube of " + text(edge) + " m would fit");
}

}  // namespace

FieldRegion field_region(const Eigen::AlignedBox3d& region, double resolution, double max_distance,
                         std::size_t memory_limit) {
  if (!(max_distance > 0.0)) {
    throw std::invalid_argument("distance field: max_distance is " + std::to_string(max_distance) +
                                ", expected metres > 0");
  }
  if (region.isEmpty() || !region.min().allFinite() || !region.max().allFinite()) {
    throw std::invalid_argument(
        "distance field: the region is empty or not finite, expected min <= max in metres");
  }
  // From cubes of the tree on, which tiles then consist of: these are read many times as fast.
  const Eigen::Array3d low = (region.min().array() / resolution / cube_cells).floor() * cube_cells;
  const Eigen::Array3d high = (region.max().array() / resolution).ceil().max(low + 1.0);
  if (low.minCoeff() < -farthest_cell || high.maxCoeff() > farthest_cell) {
    throw std::invalid_argument("distance field: the region reaches beyond " +
                                short_text(farthest_cell * resolution) + " m from the origin");
  }
  const Eigen::Array3d size = high - low;
  const double bytes = tiles_of(size) * bytes_of_a_tile;
  if (bytes > static_cast<double>(memory_limit)) {
    refuse_size(region.sizes(), bytes, resolution, memory_limit);
  }
  return {low.matrix().cast<int>(), size.matrix().cast<int>(), resolution,
          std::min(max_distance, BlockedSpace::most_voxels * resolution)};
}

std::size_t field_bytes(const FieldRegion& region) {
  return static_cast<std::size_t>(tiles_of(region.size.cast<double>().array()) * bytes_of_all_of_a_tile);
}

}  // namespace clearway
