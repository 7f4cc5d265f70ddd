#include "planning/constraint/nearest_voxels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace clearway {
namespace {

constexpr std::size_t remembered = 16384;  // a power of two
constexpr int deepest = 3;                 ///< neighbours of neighbours that are asked

/// Four voxels one above the other lie in one line of the cache.
std::size_t place_of(VoxelKey key) {
  const VoxelKey four = (key >> 2U) * 0x9e3779b97f4a7c15U >> 38U;
  return static_cast<std::size_t>(four << 2U | (key & 3U)) & (remembered - 1);
}

/// Between a voxel's middle and a cube so many voxels away, half voxels, squared.
int squared_gap(const Eigen::Vector3i& away) {
  int sum = 0;
  for (const int k : away) sum += k == 0 ? 0 : (2 * std::abs(k) - 1) * (2 * std::abs(k) - 1);
  return sum;
}

constexpr int no_offset = 127;
/// Squared distances to cubes at most 89 voxels away change by no more than this from voxel to voxel.
constexpr int largest_fall = 8 * 90;

/// The k for which one voxel further the squared gap has fallen by `fall`: 0 by none, along a wall.
constexpr int offset_found(int fall) {
  if (fall == 1) return 1;
  if (fall == -1 || fall == 0) return 0;
  if (fall % 8 != 0) return no_offset;
  return fall > 0 ? fall / 8 + 1 : fall / 8;
}

constexpr auto offsets = [] {
  std::array<std::int8_t, 2 * largest_fall + 1> table{};
  for (int fall = -largest_fall; fall <= largest_fall; ++fall)
    table[static_cast<std::size_t>(fall + largest_fall)] = static_cast<std::int8_t>(offset_found(fall));
  return table;
}();

/// Of a voxel to one that shares a face with it; a negative distance is none.
int offset_of(int squared, int next) {
  const int fall = squared - next;
  if (next < 0 || fall < -largest_fall || fall > largest_fall) return no_offset;
  return offsets[static_cast<std::size_t>(fall + largest_fall)];
}

}  // namespace

NearestVoxels::NearestVoxels(const BlockedSpace& space)
    : space_(space), resolution_(space.resolution()), places_(remembered) {
  const double half_voxels = 2.0 * (1.0 - 1e-9) * space.max_distance() / resolution_;
  beyond_ = static_cast<int>(std::ceil(half_voxels * half_voxels));
}

void NearestVoxels::look_up(std::span<const VoxelKey> voxels, std::span<VoxelKey> out) {
  missing_.clear();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Place& place = places_[place_of(voxels[i])];
    out[i] = place.cube;
    if (place.voxel != voxels[i]) missing_.push_back(i);
  }
  // First the field is read for all, so that the processor waits for many places in memory at once.
  squares_.resize(missing_.size());
  for (std::size_t k = 0; k < missing_.size(); ++k)
    squares_[k] = space_.squared_around(voxel_of(voxels[missing_[k]]));
  for (std::size_t k = 0; k < missing_.size(); ++k) {
    const VoxelKey voxel = voxels[missing_[k]];
    const Offset offset = offset_by_field(voxel_of(voxel), squares_[k], 0);
    out[missing_[k]] = offset[0] == nothing ? no_voxel : voxel + voxel_step(offset[0], offset[1], offset[2]);
    places_[place_of(voxel)] = {voxel, out[missing_[k]]};
  }
  looked_up_ += missing_.size();
}

NearestVoxels::Offset NearestVoxels::offset_by_field(const Eigen::Vector3i& voxel, const Squares& squared,
                                                     int depth) {
  if (squared[0] == 0) return {0, 0, 0, 0};
  if (squared[0] >= beyond_) return {nothing, 0, 0, 0};
  Offset offset{nothing, 0, 0, 0};
  const bool is_found = squared[0] > 0 && (by_differences(voxel, squared, offset) ||
                                           by_neighbours(voxel, squared, depth, offset));
  if (is_found || depth > 0) return offset;
  ++searched_;
  const NearestBlocked nearest =
      space_.nearest((voxel.cast<double>().array() + 0.5) * resolution_, space_.max_distance());
  if (!nearest.found) return {nothing, 0, 0, 0};
  const Eigen::Vector3i away = (nearest.voxel / resolution_).array().floor().matrix().cast<int>() - voxel;
  return {static_cast<std::int8_t>(away.x()), static_cast<std::int8_t>(away.y()),
          static_cast<std::int8_t>(away.z()), 0};
}

/// Where the neighbours along each axis see the same cube, their squared distances determine where it lies.
bool NearestVoxels::by_differences(const Eigen::Vector3i& voxel, const Squares& squared,
                                   Offset& offset) const {
  int candidates[3][2];
  int count[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int behind = offset_of(squared[0], squared[2 * axis + 2]);
    const int before = offset_of(squared[0], squared[2 * axis + 1]);
    int& number = count[axis] = 0;
    if (behind != no_offset) candidates[axis][number++] = behind;
    if (before != no_offset && -before != behind) candidates[axis][number++] = -before;
  }
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) {
      for (int k = 0; k < count[2]; ++k) {
        const Eigen::Vector3i away(candidates[0][i], candidates[1][j], candidates[2][k]);
        if (squared_gap(away) != squared[0]) continue;
        if (!space_.is_voxel_blocked(voxel + away)) continue;
        for (int axis = 0; axis < 3; ++axis)
          offset[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(away[axis]);
        return true;
      }
    }
  }
  return false;
}

/// Else the neighbour on the way to the nearest cube most likely sees it, too.
bool NearestVoxels::by_neighbours(const Eigen::Vector3i& voxel, const Squares& squared, int depth,
                                  Offset& offset) {
  if (depth >= deepest) return false;
  std::array<std::size_t, 6> order{1, 2, 3, 4, 5, 6};
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(squared[a], a) < std::pair(squared[b], b);
  });
  for (const std::size_t i : order) {
    if (squared[i] < 0) continue;
    if (squared[i] >= squared[0]) break;
    Eigen::Vector3i next = voxel;
    next[static_cast<Eigen::Index>(i - 1) / 2] += i % 2 == 1 ? -1 : 1;
    const Offset found = offset_by_field(next, space_.squared_around(next), depth + 1);
    if (found[0] == nothing) continue;
    const Eigen::Vector3i away = next - voxel + Eigen::Vector3i(found[0], found[1], found[2]);
    if (squared_gap(away) != squared[0]) continue;
    for (int axis = 0; axis < 3; ++axis)
      offset[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(away[axis]);
    return true;
  }
  return false;
}

}  // namespace clearway
