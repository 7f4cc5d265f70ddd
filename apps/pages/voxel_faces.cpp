#include "apps/pages/voxel_faces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace clearway {
namespace {

using Cell = VoxelBricks::Cell;
using Cube = VoxelBricks::Cube;
using Bits = VoxelBricks::Bits;

constexpr Bits no_bits{};
constexpr Bits all_bits{~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL};

/// The bits of a brick that have a bit beside them in a direction; `beside` is the brick there.
Bits covered(const Bits& brick, const Bits& beside, int direction) {
  constexpr std::uint64_t low_x = 0x0101010101010101ULL, high_x = low_x << 7;
  Bits result{};
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t b = brick[z], n = beside[z];
    switch (direction) {
      case 0:
        result[z] = (b & ~high_x) << 1 | (n & high_x) >> 7;
        break;
      case 1:
        result[z] = (b & ~low_x) >> 1 | (n & low_x) << 7;
        break;
      case 2:
        result[z] = b << 8 | n >> 56;
        break;
      case 3:
        result[z] = b >> 8 | n << 56;
        break;
      case 4:
        result[z] = z > 0 ? brick[z - 1] : beside[7];
        break;
      default:
        result[z] = z < 7 ? brick[z + 1] : beside[0];
    }
  }
  return result;
}

/// An 8 x 8 matrix of bits, a byte a row, on its other side.
std::uint64_t transposed(std::uint64_t x) {
  std::uint64_t t = (x ^ x >> 7) & 0x00aa00aa00aa00aaULL;
  x ^= t ^ t << 7;
  t = (x ^ x >> 14) & 0x0000cccc0000ccccULL;
  x ^= t ^ t << 14;
  t = (x ^ x >> 28) & 0x00000000f0f0f0f0ULL;
  return x ^ t ^ t << 28;
}

/// A layer of a brick across an axis a: bit 8 v + u, with u along (a+1)%3 and v along (a+2)%3.
std::uint64_t layer_of(const Bits& bits, int axis, unsigned layer) {
  if (axis == 2) return bits[layer];
  std::uint64_t rows = 0;
  for (unsigned z = 0; z < 8; ++z) {
    const std::uint64_t row = axis == 0
                                  ? (bits[z] >> layer & 0x0101010101010101ULL) * 0x0102040810204080ULL >> 56
                                  : bits[z] >> (8 * layer) & 0xff;
    rows |= row << (8 * z);
  }
  return axis == 0 ? rows : transposed(rows);
}

/// Walks over the faces of a set that no other cell of it touches. `Sink` takes `squares(direction, layer,
/// low, mask, edge)`, up to 8 x 8 squares in a plane, and `square(direction, layer, low, edge)`; `low` is the
/// lowest voxel along u and v.
template <class Sink>
class Surface {
 public:
  Surface(const VoxelBricks& set, Sink& sink) : set_(set), sink_(sink) {
    codes_.reserve(set.cubes().size());
    for (const Cube& cube : set.cubes()) codes_.push_back(cube.code);
  }

  void walk() {
    for (const Cube& cube : set_.cubes()) {
      const Cell low = VoxelBricks::low_of(cube.code);
      for (int direction = 0; direction < 6; ++direction) {
        if (cube.bits != Cube::full)
          expose_brick(set_.bits(cube), low, direction);
        else
          expose_cube(low, cube.level, direction);
      }
    }
  }

 private:
  int cell() const { return 1 << set_.cell_level(); }

  void expose_brick(const Bits& bits, const Cell& low, int direction) {
    const Bits* beside = &no_bits;
    Cell next = low;
    next[static_cast<std::size_t>(direction / 2)] += (direction % 2 == 1 ? 8 : -8) * cell();
    if (is_inside(next, direction)) beside = &bits_at(VoxelBricks::code_of(next));
    Bits exposed = covered(bits, *beside, direction);
    std::uint64_t any = 0;
    for (std::size_t z = 0; z < 8; ++z) any |= exposed[z] = bits[z] & ~exposed[z];
    if (any == 0) return;
    const int axis = direction / 2;
    for (unsigned layer = 0; layer < 8; ++layer) {
      const std::uint64_t mask = layer_of(exposed, axis, layer);
      if (mask == 0) continue;
      const int last = direction % 2 == 1 ? cell() - 1 : 0;
      sink_.squares(direction, low[static_cast<std::size_t>(axis)] + static_cast<int>(layer) * cell() + last,
                    low, mask, cell());
    }
  }

  void expose_cube(const Cell& low, int level, int direction) {
    const auto axis = static_cast<std::size_t>(direction / 2);
    const int side = 1 << level;
    const bool positive = direction % 2 == 1;
    Cell beside = low;
    beside[axis] += positive ? side : -side;
    layer_ = positive ? low[axis] + side - 1 : low[axis];
    if (is_inside(beside, direction))
      expose(beside, level, direction);
    else
      sink_.square(direction, layer_, beside, side);
  }

  /// `beside` is the lowest voxel of the cube across the face: drops the face where the set covers that cube,
  /// keeps it where the set is absent, and asks the four touching children where it is mixed.
  void expose(const Cell& beside, int level, int direction) {
    const std::uint64_t code = VoxelBricks::code_of(beside), end = code + VoxelBricks::volume(level);
    const std::size_t after = after_code(code);
    bool mixed = after < codes_.size() && codes_[after] < end;
    if (after > 0) {
      const Cube& before = set_.cubes()[after - 1];
      if (before.code + VoxelBricks::volume(before.level) >= end) {
        if (before.bits != Cube::full) expose_against(set_.bits(before), beside, direction);
        return;
      }
      mixed |= before.code == code;
    }
    if (!mixed) return sink_.square(direction, layer_, beside, 1 << level);
    const int axis = direction / 2, half = 1 << (level - 1);
    Cell near = beside;
    if (direction % 2 == 0) near[static_cast<std::size_t>(axis)] += half;
    for (int child = 0; child < 4; ++child) {
      Cell low = near;
      low[static_cast<std::size_t>((axis + 1) % 3)] += child % 2 == 1 ? half : 0;
      low[static_cast<std::size_t>((axis + 2) % 3)] += child / 2 == 1 ? half : 0;
      expose(low, level - 1, direction);
    }
  }

  /// The faces of a large cube that a brick beside it leaves open.
  void expose_against(const Bits& brick, const Cell& beside, int direction) {
    const std::uint64_t open = ~layer_of(brick, direction / 2, direction % 2 == 1 ? 0 : 7);
    if (open != 0) sink_.squares(direction, layer_, beside, open, cell());
  }

  static bool is_inside(const Cell& low, int direction) {
    const int at = low[static_cast<std::size_t>(direction / 2)];
    return at >= 0 && at < VoxelBricks::space;
  }

  std::size_t after_code(std::uint64_t code) const {
    return static_cast<std::size_t>(std::upper_bound(codes_.begin(), codes_.end(), code) - codes_.begin());
  }

  const Bits& bits_at(std::uint64_t code) const {
    const std::size_t after = after_code(code);
    if (after == 0) return no_bits;
    const Cube& cube = set_.cubes()[after - 1];
    if (cube.code + VoxelBricks::volume(cube.level) <= code) return no_bits;
    return cube.bits == Cube::full ? all_bits : set_.bits(cube);
  }

  const VoxelBricks& set_;
  Sink& sink_;
  std::vector<std::uint64_t> codes_;
  int layer_ = 0;
};

/// Makes quads: of bricks a row of squares is one.
struct QuadSink {
  std::vector<VoxelQuad> quads{};

  void add(int direction, int layer, int u, int v, int width, int height) {
    quads.push_back({static_cast<std::uint16_t>(direction), static_cast<std::uint16_t>(layer),
                     static_cast<std::uint16_t>(u), static_cast<std::uint16_t>(v),
                     static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)});
  }
  void square(int direction, int layer, const Cell& low, int edge) {
    const auto axis = static_cast<std::size_t>(direction / 2);
    add(direction, layer, low[(axis + 1) % 3], low[(axis + 2) % 3], edge, edge);
  }
  void squares(int direction, int layer, const Cell& low, std::uint64_t mask, int edge) {
    const auto axis = static_cast<std::size_t>(direction / 2);
    for (int v = 0; v < 8; ++v) {
      auto row = static_cast<unsigned>(mask >> (8 * v) & 0xff);
      while (row != 0) {
        const int first = std::countr_zero(row), length = std::countr_one(row >> first);
        add(direction, layer, low[(axis + 1) % 3] + first * edge, low[(axis + 2) % 3] + v * edge,
            length * edge, edge);
        row &= ~(((1U << length) - 1) << first);
      }
    }
  }
};

struct CountSink {
  std::uint64_t faces = 0;
  void square(int, int, const Cell&, int) { ++faces; }
  void squares(int, int, const Cell&, std::uint64_t mask, int) {
    faces += static_cast<std::uint64_t>(std::popcount(mask));
  }
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

[[noreturn]] void refuse(const PageVoxels& voxels, const std::string& why) {
  throw std::invalid_argument("page voxels '" + voxels.state + "': " + why);
}

}  // namespace

void PageVoxels::add(const Eigen::Vector3d& center, double edge) {
  if (!(size > 0)) refuse(*this, "size must be > 0");
  const double voxels = std::round(edge / size);
  if (!(voxels >= 1 && voxels <= VoxelBricks::space))
    refuse(*this, "a leaf has an edge outside 1 to 65536 voxels");
  const int side = static_cast<int>(voxels);
  if (!std::has_single_bit(static_cast<unsigned>(side)))
    refuse(*this, "a leaf has an edge that is not a power of two voxels");
  Cell low{};
  for (int a = 0; a < 3; ++a) {
    const double at = center[a] / size - 0.5 * side + kOriginVoxel;
    const double rounded = std::round(at);
    if (!(rounded >= 0 && rounded + side <= VoxelBricks::space))
      refuse(*this, "a leaf lies outside the octree's space");
    if (std::abs(at - rounded) > 0.25) refuse(*this, "a leaf does not lie on the voxel grid");
    low[static_cast<std::size_t>(a)] = static_cast<int>(rounded);
    if (low[static_cast<std::size_t>(a)] % side != 0) refuse(*this, "a leaf is not aligned to its own edge");
  }
  const int level = std::countr_zero(static_cast<unsigned>(side));
  try {
    cells.add(low, level);
  } catch (const std::invalid_argument& overlap) {
    refuse(*this, std::string("a leaf ") + overlap.what());
  }
  count += VoxelBricks::volume(level);
}

std::vector<VoxelQuad> exposed_faces(const PageVoxels& voxels) {
  VoxelBricks sorted = voxels.cells;
  try {
    sorted.sort();
  } catch (const std::invalid_argument& overlap) {
    refuse(voxels, std::string("a leaf ") + overlap.what());
  }
  QuadSink sink;
  Surface(sorted, sink).walk();
  merge_rectangles(sink.quads);
  return std::move(sink.quads);
}

bool is_drawn_where_any(std::string_view state) { return state == "occupied" || state == "conflict"; }

std::uint64_t count_faces(const VoxelBricks& cells) {
  CountSink sink;
  Surface(cells, sink).walk();
  return sink.faces;
}

}  // namespace clearway
