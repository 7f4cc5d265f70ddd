#include "apps/pages/voxel_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace clearway {
namespace {

constexpr int kSpace = 65536;  // voxels along an edge of the octree's space
constexpr int kMaxLevel = 16;

using Cell = std::array<int, 3>;

/// A leaf's edge is 2^level voxels; `code` is the Morton code of its lowest voxel, so that the leaf covers
/// the codes [code, code + 8^level) and no others.
struct Cube {
  std::uint64_t code;
  int level;
  Cell low;
};

std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffULL;
  x = (x | x << 16) & 0x001f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

std::uint64_t morton(const Cell& c) {
  return spread_bits(static_cast<std::uint64_t>(c[0])) | spread_bits(static_cast<std::uint64_t>(c[1])) << 1 |
         spread_bits(static_cast<std::uint64_t>(c[2])) << 2;
}

std::uint64_t volume(int level) { return std::uint64_t{1} << (3 * level); }

[[noreturn]] void refuse(const PageVoxels& voxels, std::size_t leaf, const char* why) {
  throw std::invalid_argument("page voxels '" + voxels.state + "': leaf " + std::to_string(leaf) + " " + why);
}

double leaf_size(const PageVoxels& voxels, std::size_t i) {
  return voxels.sizes.empty() ? voxels.size : static_cast<double>(voxels.sizes[i]);
}

Cube to_cube(const PageVoxels& voxels, std::size_t i) {
  const double edge = std::round(leaf_size(voxels, i) / voxels.size);
  if (!(edge >= 1 && edge <= kSpace)) refuse(voxels, i, "has an edge outside 1 to 65536 voxels");
  const int side = static_cast<int>(edge);
  if ((side & (side - 1)) != 0) refuse(voxels, i, "has an edge that is not a power of two voxels");
  Cube cube{0, 0, {}};
  while ((1 << cube.level) < side) ++cube.level;
  for (int a = 0; a < 3; ++a) {
    const double low = static_cast<double>(voxels.centers[i][a]) / voxels.size - 0.5 * side + kOriginVoxel;
    const double rounded = std::round(low);
    if (!(rounded >= 0 && rounded + side <= kSpace)) refuse(voxels, i, "lies outside the octree's space");
    if (std::abs(low - rounded) > 0.25) refuse(voxels, i, "does not lie on the voxel grid");
    cube.low[a] = static_cast<int>(rounded);
    if (cube.low[a] % side != 0) refuse(voxels, i, "is not aligned to its own edge");
  }
  cube.code = morton(cube.low);
  return cube;
}

std::vector<Cube> sorted_cubes(const PageVoxels& voxels) {
  if (!(voxels.size > 0)) throw std::invalid_argument("page voxels '" + voxels.state + "': size must be > 0");
  if (!voxels.sizes.empty() && voxels.sizes.size() != voxels.centers.size())
    throw std::invalid_argument("page voxels '" + voxels.state + "': one size per center is needed");
  std::vector<Cube> cubes;
  cubes.reserve(voxels.centers.size());
  for (std::size_t i = 0; i < voxels.centers.size(); ++i) cubes.push_back(to_cube(voxels, i));
  const auto by_code = [](const Cube& a, const Cube& b) { return a.code < b.code; };
  if (!std::is_sorted(cubes.begin(), cubes.end(), by_code)) std::sort(cubes.begin(), cubes.end(), by_code);
  for (std::size_t i = 1; i < cubes.size(); ++i)
    if (cubes[i].code < cubes[i - 1].code + volume(cubes[i - 1].level)) refuse(voxels, i, "overlaps another");
  return cubes;
}

/// Emits the part of one leaf's face that no other leaf of the set touches.
class Surface {
 public:
  explicit Surface(const std::vector<Cube>& cubes) : cubes_(cubes) {
    codes_.reserve(cubes.size());
    for (const Cube& cube : cubes) codes_.push_back(cube.code);
  }

  std::vector<VoxelQuad> extract() {
    for (const Cube& cube : cubes_)
      for (int direction = 0; direction < 6; ++direction) {
        const int axis = direction / 2, side = 1 << cube.level;
        const bool positive = direction % 2 == 1;
        Cell beside = cube.low;
        beside[axis] += positive ? side : -side;
        layer_ = positive ? cube.low[axis] + side - 1 : cube.low[axis];
        if (beside[axis] < 0 || beside[axis] >= kSpace)
          emit(beside, cube.level, direction);
        else
          expose(beside, cube.level, direction);
      }
    return std::move(quads_);
  }

 private:
  /// `beside` is the lowest voxel of the cube across the face: drops the face where the set covers that cube,
  /// keeps it where the set is absent, and asks the four touching children where it is mixed.
  void expose(const Cell& beside, int level, int direction) {
    const std::uint64_t code = morton(beside), end = code + volume(level);
    const auto after =
        static_cast<std::size_t>(std::upper_bound(codes_.begin(), codes_.end(), code) - codes_.begin());
    bool occupied_inside = after < codes_.size() && codes_[after] < end;
    if (after > 0) {
      const Cube& before = cubes_[after - 1];
      if (before.code + volume(before.level) >= end) return;
      occupied_inside |= before.code == code;
    }
    if (!occupied_inside) return emit(beside, level, direction);
    const int axis = direction / 2, half = 1 << (level - 1);
    Cell near = beside;
    if (direction % 2 == 0) near[axis] += half;
    for (int child = 0; child < 4; ++child) {
      Cell low = near;
      low[(axis + 1) % 3] += child % 2 == 1 ? half : 0;
      low[(axis + 2) % 3] += child / 2 == 1 ? half : 0;
      expose(low, level - 1, direction);
    }
  }

  void emit(const Cell& beside, int level, int direction) {
    const int axis = direction / 2;
    const auto side = std::uint32_t{1} << level;
    quads_.push_back({static_cast<std::uint16_t>(direction), static_cast<std::uint16_t>(layer_),
                      static_cast<std::uint16_t>(beside[(axis + 1) % 3]),
                      static_cast<std::uint16_t>(beside[(axis + 2) % 3]), side, side});
  }

  const std::vector<Cube>& cubes_;
  std::vector<std::uint64_t> codes_;
  std::vector<VoxelQuad> quads_;
  int layer_ = 0;
};

std::uint64_t row_order(const VoxelQuad& q) {
  return std::uint64_t{q.direction} << 48 | std::uint64_t{q.layer} << 32 | std::uint64_t{q.v} << 16 | q.u;
}
std::uint64_t column_order(const VoxelQuad& q) {
  return std::uint64_t{q.direction} << 48 | std::uint64_t{q.layer} << 32 | std::uint64_t{q.u} << 16 | q.v;
}

void sort_by(std::vector<VoxelQuad>& quads, std::uint64_t (*order)(const VoxelQuad&)) {
  std::sort(quads.begin(), quads.end(),
            [order](const VoxelQuad& a, const VoxelQuad& b) { return order(a) < order(b); });
}

/// Appends each quad to the last kept one when `join` can make one rectangle of both.
template <class Join>
void merge_neighbours(std::vector<VoxelQuad>& quads, Join join) {
  std::size_t kept = 0;
  for (const VoxelQuad& quad : quads)
    if (kept == 0 || !join(quads[kept - 1], quad)) quads[kept++] = quad;
  quads.resize(kept);
}

/// Equal neighbours become rows, then equal rows become rectangles.
void merge_rectangles(std::vector<VoxelQuad>& quads) {
  const auto same_plane = [](const VoxelQuad& a, const VoxelQuad& b) {
    return a.direction == b.direction && a.layer == b.layer;
  };
  sort_by(quads, row_order);
  merge_neighbours(quads, [&](VoxelQuad& a, const VoxelQuad& b) {
    if (!same_plane(a, b) || a.v != b.v || a.height != b.height || a.u + a.width != b.u) return false;
    a.width += b.width;
    return true;
  });
  sort_by(quads, column_order);
  merge_neighbours(quads, [&](VoxelQuad& a, const VoxelQuad& b) {
    if (!same_plane(a, b) || a.u != b.u || a.width != b.width || a.v + a.height != b.v) return false;
    a.height += b.height;
    return true;
  });
  sort_by(quads, row_order);
}

}  // namespace

std::vector<VoxelQuad> exposed_faces(const PageVoxels& voxels) {
  const std::vector<Cube> cubes = sorted_cubes(voxels);
  std::vector<VoxelQuad> quads = Surface(cubes).extract();
  merge_rectangles(quads);
  return quads;
}

std::uint64_t count_voxels(const PageVoxels& voxels) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < voxels.centers.size(); ++i) {
    const auto side = static_cast<std::uint64_t>(std::llround(leaf_size(voxels, i) / voxels.size));
    count += side * side * side;
  }
  return count;
}

}  // namespace clearway
