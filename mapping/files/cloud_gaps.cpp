#include "mapping/files/cloud_gaps.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

namespace clearway {
namespace {

constexpr double farthest = 1.95;    ///< edges between two points that are joined
constexpr double empty = 0.35;       ///< of their distance: how near to the middle no other point is
constexpr double passed = 0.1;       ///< edges that a join passes of a voxel at least
constexpr double same_point = 0.25;  ///< edges
constexpr int block = 8;             ///< edge of a block of voxels

struct SurfacePoint {
  Eigen::Vector3i cell;
  Eigen::Vector3f point;  ///< in edges, from the corner of its cell
};

using Key = std::array<int, 3>;
Key key_of(const Eigen::Vector3i& cell) { return {cell.x(), cell.y(), cell.z()}; }

/// One point of each quarter of a voxel along each axis, by voxels.
std::vector<SurfacePoint> distinct_points(const std::vector<Eigen::Vector3f>& points,
                                          const std::vector<Eigen::Vector3i>& cells, double edge) {
  const auto part_of = [](const SurfacePoint& row) {
    return key_of((row.point.array() / static_cast<float>(same_point)).floor().cast<int>().matrix());
  };
  std::vector<SurfacePoint> rows;
  rows.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    rows.push_back({cells[i], (points[i].cast<double>() / edge - cells[i].cast<double>()).cast<float>()});
  const auto place = [&](const SurfacePoint& row) {
    return std::tuple(key_of(row.cell), part_of(row), row.point.x(), row.point.y(), row.point.z());
  };
  std::sort(rows.begin(), rows.end(),
            [&](const SurfacePoint& a, const SurfacePoint& b) { return place(a) < place(b); });
  rows.erase(std::unique(rows.begin(), rows.end(),
                         [&](const SurfacePoint& a, const SurfacePoint& b) {
                           return a.cell == b.cell && part_of(a) == part_of(b);
                         }),
             rows.end());
  return rows;
}

/// Which voxels hold points, in blocks.
class HeldCells {
 public:
  explicit HeldCells(const std::vector<SurfacePoint>& rows) {
    for (const SurfacePoint& row : rows) blocks_[block_of(row.cell)].set(place_in_block(row.cell));
  }

  /// Calls `visit` with each empty voxel that has points in two of its 26 neighbours on opposite sides.
  template <typename Visit>
  void visit_between(const Visit& visit) const {
    std::map<Key, bool> near;  // blocks that hold points, and those beside them
    for (const auto& [key, bits] : blocks_)
      for (int k = 0; k < 27; ++k) near[{key[0] + k % 3 - 1, key[1] + k / 3 % 3 - 1, key[2] + k / 9 - 1}];
    for (const auto& [key, ignored] : near) visit_block(key, visit);
  }

 private:
  using Bits = std::bitset<block * block * block>;
  static constexpr int wide = block + 2;

  static Key block_of(const Eigen::Vector3i& cell) { return {cell.x() >> 3, cell.y() >> 3, cell.z() >> 3}; }
  static std::size_t place_in_block(const Eigen::Vector3i& cell) {
    return static_cast<std::size_t>(((cell.z() & 7) * block + (cell.y() & 7)) * block + (cell.x() & 7));
  }

  template <typename Visit>
  void visit_block(const Key& key, const Visit& visit) const {
    std::array<bool, wide * wide * wide> held{};
    const auto at = [](int x, int y, int z) { return static_cast<std::size_t>((z * wide + y) * wide + x); };
    const Eigen::Vector3i corner = block * Eigen::Vector3i(key[0], key[1], key[2]);
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i side(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const auto found = blocks_.find({key[0] + side.x(), key[1] + side.y(), key[2] + side.z()});
      if (found == blocks_.end()) continue;
      for (std::size_t i = 0; i < found->second.size(); ++i) {
        if (!found->second.test(i)) continue;
        const auto index = static_cast<int>(i);
        const Eigen::Vector3i place = block * side + Eigen::Vector3i(index % 8, index / 8 % 8, index / 64);
        if (((place.array() >= -1) && (place.array() <= block)).all())
          held[at(place.x() + 1, place.y() + 1, place.z() + 1)] = true;
      }
    }
    for (int z = 1; z <= block; ++z)
      for (int y = 1; y <= block; ++y)
        for (int x = 1; x <= block; ++x) {
          if (held[at(x, y, z)]) continue;
          std::uint32_t sides = 0;
          for (int k = 0; k < 27; ++k)
            sides |= static_cast<std::uint32_t>(held[at(x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1)])
                     << k;
          if (has_opposite(sides)) visit(corner + Eigen::Vector3i(x - 1, y - 1, z - 1));
        }
  }

  /// Whether two of the sides are on opposite sides along some axis, and on the same side along none.
  static bool has_opposite(std::uint32_t sides) {
    static const std::array<std::uint32_t, 27> opposite = [] {
      std::array<std::uint32_t, 27> result{};
      const auto side = [](int k) { return Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1); };
      for (int a = 0; a < 27; ++a)
        for (int b = 0; b < 27; ++b)
          if ((side(a).array() * side(b).array() <= 0).all() && side(a).dot(side(b)) < 0)
            result[static_cast<std::size_t>(a)] |= std::uint32_t{1} << b;
      return result;
    }();
    for (std::uint32_t rest = sides; rest != 0; rest &= rest - 1)
      if ((opposite[static_cast<std::size_t>(std::countr_zero(rest))] & sides) != 0) return true;
    return false;
  }

  std::map<Key, Bits> blocks_;
};

/// Whether the segment passes a part of the voxel about the origin that counts. What lies in a face belongs
/// to the voxel above it.
bool passes_voxel(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  double first = 0.0, last = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double step = to[i] - from[i];
    if (step == 0.0) {
      if (!(from[i] >= -0.5 && from[i] < 0.5)) return false;
      continue;
    }
    const double a = (-0.5 - from[i]) / step, b = (0.5 - from[i]) / step;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return (last - first) * (to - from).norm() >= passed;
}

/// Whether two of these, in edges from the voxel's centre, are joined through it.
bool are_joined(const std::vector<Eigen::Vector3d>& near) {
  for (std::size_t a = 0; a < near.size(); ++a) {
    for (std::size_t b = a + 1; b < near.size(); ++b) {
      const double apart = (near[b] - near[a]).squaredNorm();
      if (apart > farthest * farthest || !passes_voxel(near[a], near[b])) continue;
      const Eigen::Vector3d middle = (near[a] + near[b]) / 2.0;
      const bool is_empty = std::none_of(near.begin(), near.end(), [&](const Eigen::Vector3d& other) {
        return (other - middle).squaredNorm() < empty * empty * apart;
      });
      if (is_empty) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Eigen::Vector3i> cells_between(const std::vector<Eigen::Vector3f>& points,
                                           const std::vector<Eigen::Vector3i>& cells, double edge) {
  const std::vector<SurfacePoint> rows = distinct_points(points, cells, edge);
  std::vector<Eigen::Vector3i> between;
  std::vector<Eigen::Vector3d> near;
  HeldCells(rows).visit_between([&](const Eigen::Vector3i& cell) {
    near.clear();
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i side(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const Key key = key_of(cell + side);
      auto row = std::lower_bound(
          rows.begin(), rows.end(), key,
          [](const SurfacePoint& one, const Key& other) { return key_of(one.cell) < other; });
      for (; row != rows.end() && key_of(row->cell) == key; ++row)
        near.push_back(row->point.cast<double>() + side.cast<double>() - Eigen::Vector3d::Constant(0.5));
    }
    if (are_joined(near)) between.push_back(cell);
  });
  std::sort(between.begin(), between.end(),
            [](const Eigen::Vector3i& a, const Eigen::Vector3i& b) { return key_of(a) < key_of(b); });
  return between;
}

}  // namespace clearway
