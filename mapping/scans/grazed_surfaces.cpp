#include "mapping/scans/grazed_surfaces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "mapping/system/parallel.hpp"
#include "mapping/voxels/tile_node.hpp"

namespace clearway {
namespace {

constexpr int reach = 10, enough = 6;  ///< voxels along the line of sight, and how many of them are occupied
constexpr int most_thick = 3;          ///< voxels of a layer, and
constexpr double most_metres = 0.12;   ///< metres
constexpr int around = 16;             ///< directions across the line of sight
constexpr int tile_level = 5;
constexpr int far = 20;               ///< voxels before and behind: from so many the angle is measured
constexpr double steepest = 0.044;    ///< sine of 2.5 degrees
constexpr double same_view = 0.9986;  ///< cosine of 3 degrees

/// The directions across it, in a plane.
const std::array<Eigen::Vector2d, around>& ways_around() {
  static const std::array<Eigen::Vector2d, around> ways = [] {
    std::array<Eigen::Vector2d, around> made;
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / around;
      made[static_cast<std::size_t>(i)] = {std::cos(angle), std::sin(angle)};
    }
    return made;
  }();
  return ways;
}

/// Looks up voxels that lie near each other.
class Occupied {
 public:
  explicit Occupied(const FusedTree& tree) : tree_(tree) {}

  bool operator()(const Eigen::Vector3d& place) {
    if ((place.array() < -32768.0).any() || (place.array() >= 32768.0).any()) return false;
    const Eigen::Vector3i cell = place.array().floor().cast<int>();
    if (const std::uint64_t key = ScanGrid::key_of(cell); key != key_) {
      key_ = key;
      tile_ = tile_node(tree_, cell);
    }
    const FusedNode* const leaf = leaf_below(tile_, ScanTile::bit_of(cell));
    return leaf != nullptr && leaf->observed() && tree_.isNodeOccupied(leaf);
  }

 private:
  const FusedTree& tree_;
  std::uint64_t key_ = ~std::uint64_t{0};
  const FusedNode* tile_ = nullptr;
};

bool goes_on(Occupied& is_occupied, const Eigen::Vector3d& place, const Eigen::Vector3d& way) {
  int missing = 0;
  for (int k = 1; k <= reach; ++k)
    if (!is_occupied(place + k * way) && ++missing > reach - enough) return false;
  return true;
}

/// Of a place and the direction in which something may reach from it, across the line of sight.
struct Side {
  bool is_filled = false;  ///< occupied as far as a layer may be thick
  bool is_wide = false;    ///< occupied two voxels away
};

bool is_thin(const std::array<Side, around>& sides, int normal) {
  constexpr int eighth = around / 8, half = around / 2, quarter = around / 4;
  const auto side = [&](int i) { return sides[static_cast<std::size_t>((i + around) % around)]; };
  for (int k = -eighth; k <= eighth; ++k)
    if (side(normal + k).is_filled || side(normal + half + k).is_filled) return false;
  return side(normal + quarter).is_wide || side(normal - quarter).is_wide;
}

/// How far a layer goes along its normal for each voxel along the line of sight: least squares over the
/// occupied voxels about the line.
double slope_of(Occupied& is_occupied, const Eigen::Vector3d& place, const Eigen::Vector3d& along,
                const Eigen::Vector3d& normal) {
  double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (int k = -far; k <= far; ++k) {
    for (int n = -most_thick; n <= most_thick; ++n) {
      if (!is_occupied(place + k * along + n * normal)) continue;
      ++count, x += k, y += n, xx += k * k, xy += k * n;
    }
  }
  const double spread = xx - x * x / count;
  return spread > 0.0 ? (xy - x * y / count) / spread : 0.0;
}

/// From the rays' origin, in cells, to the middle of a word's cube.
Eigen::Vector3d way_to(const ScanTile& tile, unsigned word, const Eigen::Vector3d& origin) {
  return (tile.cell_of(64 * word).cast<double>().array() + 2.0).matrix() - origin;
}

/// Calls `visit` with the bits, in octree order, of the occupied voxels below a node of a tile.
template <class Visit>
void visit_occupied(const FusedTree& tree, const FusedNode& node, int level, unsigned first,
                    const Visit& visit) {
  if (!tree.isNodeOccupied(node)) return;  // an inner node has the most of its children
  if (!node.has_children()) {
    if (!node.observed()) return;
    for (unsigned i = 0; i < 1U << 3 * level; ++i) visit(first + i);
    return;
  }
  for (unsigned i = 0; i < 8; ++i)
    if (node.child(i) != nullptr)
      visit_occupied(tree, *node.child(i), level - 1, first + (i << 3 * (level - 1)), visit);
}

}  // namespace

bool GrazedSurfaces::View::is_only(const Eigen::Vector3d& other) const {
  return from == one && is_same_way(other);
}

void GrazedSurfaces::View::add(const Eigen::Vector3d& other) {
  if (from == several || is_only(other)) return;
  if (from == never) way = (127.0 * other.normalized()).array().round().cast<std::int8_t>();
  from = from == never ? one : several;
}

bool GrazedSurfaces::View::is_same_way(const Eigen::Vector3d& other) const {
  const Eigen::Vector3d first = way.cast<double>();
  return first.dot(other) > same_view * first.norm() * other.norm();
}

bool is_seen_edge_on(const FusedTree& tree, const Eigen::Vector3i& cell, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d place = cell.cast<double>().array() + 0.5, way = place - origin;
  if (way.norm() < most_thick) return false;
  const Eigen::Vector3d along = way.normalized();
  Occupied is_occupied(tree);
  if (!goes_on(is_occupied, place, along) && !goes_on(is_occupied, place, -along)) return false;
  const int thick = std::clamp(static_cast<int>(most_metres / tree.getResolution()), 1, most_thick);
  const Eigen::Vector3d across = along.unitOrthogonal(), other = along.cross(across);
  const auto direction = [&](int i) -> Eigen::Vector3d {
    const Eigen::Vector2d& unit = ways_around()[static_cast<std::size_t>(i)];
    return unit.x() * across + unit.y() * other;
  };
  std::array<Side, around> sides;
  for (int i = 0; i < around; ++i) {
    const Eigen::Vector3d step = direction(i);
    Side& side = sides[static_cast<std::size_t>(i)];
    side.is_wide = is_occupied(place + 2.0 * step);
    side.is_filled = true;
    for (int k = 1; k <= thick && side.is_filled; ++k) side.is_filled = is_occupied(place + k * step);
  }
  for (int normal = 0; normal < around / 2; ++normal)
    if (is_thin(sides, normal) && std::abs(slope_of(is_occupied, place, along, direction(normal))) < steepest)
      return true;
  return false;
}

void GrazedSurfaces::spare(const FusedTree& tree, const Eigen::Vector3d& origin, ScanTile& tile) const {
  const auto is_zero = [](std::uint64_t word) { return word == 0; };
  const FusedNode* const node = tile_node(tree, tile.corner);
  if (node == nullptr || std::all_of(tile.free.begin(), tile.free.end(), is_zero)) return;
  const auto found = views_.find(ScanGrid::key_of(tile.corner));
  unsigned asked = ~0U;  // a cube of 2 x 2 x 2 voxels; its first one speaks for all
  bool is_edge_on = false;
  visit_occupied(tree, *node, tile_level, 0, [&](unsigned bit) {
    const unsigned word = bit >> 6U;
    const std::uint64_t mask = std::uint64_t{1} << (bit & 63U);
    if ((tile.free[word] & mask) == 0 || (tile.occupied[word] & mask) != 0) return;
    if (found != views_.end() && (*found->second)[word].is_only(way_to(tile, word, origin))) return;
    if (std::exchange(asked, bit >> 3U) != bit >> 3U)
      is_edge_on = is_seen_edge_on(tree, tile.cell_of(bit), origin);
    if (is_edge_on) tile.free[word] &= ~mask;
  });
}

void GrazedSurfaces::note_hits(const ScanTile& tile, const Eigen::Vector3d& origin) {
  Views* views = nullptr;
  for (unsigned word = 0; word < ScanTile::words; ++word) {
    if (tile.occupied[word] == 0) continue;
    if (views == nullptr) {
      auto& place = views_[ScanGrid::key_of(tile.corner)];
      if (!place) place = std::make_unique<Views>();
      views = place.get();
    }
    (*views)[word].add(way_to(tile, word, origin));
  }
}

void GrazedSurfaces::weigh(const FusedTree& tree, const Eigen::Vector3d& origin, ScanGrid& grid,
                           int threads) {
  const Eigen::Vector3d from = origin / tree.getResolution();
  const std::vector<ScanTile*> tiles = grid.tiles();
  std::atomic<std::size_t> next{0};
  parallel(static_cast<std::size_t>(threads), [&](std::size_t) {
    for (std::size_t i = next++; i < tiles.size(); i = next++) spare(tree, from, *tiles[i]);
  });
  for (const ScanTile* tile : tiles) note_hits(*tile, from);
}

}  // namespace clearway
