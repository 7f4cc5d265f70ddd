#include "mapping/files/cloud_gaps.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

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

/// One point of each quarter of a voxel along each axis, by voxels: the least of them, whatever their order.
std::vector<SurfacePoint> distinct_points(const std::vector<Eigen::Vector3f>& points,
                                          const std::vector<Eigen::Vector3i>& cells, double edge) {
  struct Place {
    std::uint64_t part;  ///< 17 bits of each number of the cell, then 2 of each quarter
    std::uint32_t point;
  };
  const auto within = [&](std::size_t i) {
    return Eigen::Vector3f((points[i].cast<double>() / edge - cells[i].cast<double>()).cast<float>());
  };
  std::vector<Place> places;
  places.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f at = within(i);
    std::uint64_t cell = 0, quarter = 0;
    for (int axis = 0; axis < 3; ++axis) {
      cell = cell << 17U | static_cast<std::uint64_t>(cells[i][axis] + 65536);
      const int part = std::clamp(static_cast<int>(at[axis] / static_cast<float>(same_point)), 0, 3);
      quarter = quarter << 2U | static_cast<std::uint64_t>(part);
    }
    places.push_back({cell << 6U | quarter, static_cast<std::uint32_t>(i)});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.part < b.part; });
  const auto is_less = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::vector<SurfacePoint> kept;
  std::uint64_t last = ~std::uint64_t{0};
  for (const Place& place : places) {
    const Eigen::Vector3f at = within(place.point);
    if (place.part != last)
      kept.push_back({cells[place.point], at});
    else if (is_less(at, kept.back().point))
      kept.back().point = at;
    last = place.part;
  }
  return kept;
}

/// Which voxels hold points, in blocks.
class HeldCells {
 public:
  explicit HeldCells(const std::vector<SurfacePoint>& points) {
    for (const SurfacePoint& point : points) {
      const Eigen::Vector3i in_block = point.cell.unaryExpr([](int c) { return c & (block - 1); });
      Block& held = blocks_[block_of(point.cell)];
      held.rows[static_cast<std::size_t>(in_block.z() * block + in_block.y())] |=
          static_cast<std::uint8_t>(1U << in_block.x());
    }
  }

  /// Calls `visit` with each empty voxel that has points in two of its 26 neighbours on opposite sides.
  template <typename Visit>
  void visit_between(const Visit& visit) const {
    std::set<Key> near;  // blocks that hold points, and those beside them that these reach
    for (const auto& [key, held] : blocks_) {
      near.insert(key);
      for (int k = 0; k < 27; ++k)
        if (held.reaches(side_of(k))) near.insert(beside(key, side_of(k)));
    }
    for (const Key& key : near) visit_block(key, visit);
  }

 private:
  static constexpr int wide = block + 2;

  static Eigen::Vector3i side_of(int k) { return {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}; }
  static Key beside(const Key& key, const Eigen::Vector3i& side) {
    return {key[0] + side.x(), key[1] + side.y(), key[2] + side.z()};
  }

  /// Of 8 x 8 x 8 voxels: rows along x.
  struct Block {
    std::array<std::uint8_t, block * block> rows{};

    /// The voxels of the layer, edge or corner on that side; all where a side is 0.
    template <typename Visit>
    void visit_side(const Eigen::Vector3i& side, const Visit& visit) const {
      const auto range = [](int s) { return std::pair(s > 0 ? block - 1 : 0, s < 0 ? 0 : block - 1); };
      const auto [z0, z1] = range(side.z());
      const auto [y0, y1] = range(side.y());
      const unsigned mask = side.x() == 0 ? 0xffU : side.x() > 0 ? 0x80U : 1U;
      for (int z = z0; z <= z1; ++z)
        for (int y = y0; y <= y1; ++y)
          for (unsigned bits = rows[static_cast<std::size_t>(z * block + y)] & mask; bits != 0;
               bits &= bits - 1)
            visit(Eigen::Vector3i(std::countr_zero(bits), y, z));
    }
    bool reaches(const Eigen::Vector3i& side) const {
      bool found = false;
      visit_side(side, [&](const Eigen::Vector3i&) { found = true; });
      return found;
    }
  };

  static Key block_of(const Eigen::Vector3i& cell) { return {cell.x() >> 3, cell.y() >> 3, cell.z() >> 3}; }

  template <typename Visit>
  void visit_block(const Key& key, const Visit& visit) const {
    std::array<bool, wide * wide * wide> held{};
    const auto at = [](int x, int y, int z) { return static_cast<std::size_t>((z * wide + y) * wide + x); };
    const Eigen::Vector3i corner = block * Eigen::Vector3i(key[0], key[1], key[2]);
    Eigen::Vector3i low = Eigen::Vector3i::Constant(wide), high = Eigen::Vector3i::Constant(-1);  // of `held`
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i side = side_of(k);
      const auto found = blocks_.find(beside(key, side));
      if (found == blocks_.end()) continue;
      found->second.visit_side(-side, [&](const Eigen::Vector3i& in_block) {
        const Eigen::Vector3i place = block * side + in_block + Eigen::Vector3i::Ones();
        held[at(place.x(), place.y(), place.z())] = true;
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
      });
    }
    low = low.cwiseMax(1);  // what is between others is within their box
    high = high.cwiseMin(block);
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x) {
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

  std::map<Key, Block> blocks_;
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
