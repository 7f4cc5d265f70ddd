// Pockets, parts and necks of small hand-made volumes, and of random ones against brute force.

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "mapping/volumes/volume_voxels.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace volume_voxels_test {

using worlds::Dice;
using Cells = std::set<std::array<int, 3>>;

/// A block of `size` free cells along each axis inside the margin, less `blocked` (counted from the first).
VolumeVoxels solid(const Eigen::Vector3i& size, const Cells& blocked, std::uint16_t cap = 2500) {
  VolumeVoxels voxels;
  voxels.first = {10, -20, 30};
  voxels.resolution = 0.5;
  voxels.block = DistanceBlock(size.x() + 2, size.y() + 2, size.z() + 2, cap);
  std::fill(voxels.block.squared.begin(), voxels.block.squared.end(), std::uint16_t{0});
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x) {
        if (!blocked.contains({x, y, z})) voxels.block.squared[voxels.block.index(x + 1, y + 1, z + 1)] = cap;
      }
    }
  }
  return voxels;
}

bool is_free(const VolumeVoxels& voxels, const Eigen::Vector3i& at) {
  return voxels.block.squared[voxels.block.index(at.x(), at.y(), at.z())] != 0;
}

TEST(Pockets, ABlockedCellInsideIsAPocketAndOneAtTheFaceIsNot) {
  const VolumeVoxels voxels = solid({5, 5, 5}, {{2, 2, 2}, {0, 2, 3}});
  const auto pockets = find_pockets(voxels);
  ASSERT_EQ(pockets.size(), 1U);
  ASSERT_EQ(pockets[0].size(), 1U);
  EXPECT_EQ(voxels.cell(pockets[0][0]), Eigen::Vector3i(13, -17, 33));
  EXPECT_TRUE(voxels.center(pockets[0][0]).isApprox(Eigen::Vector3d(6.75, -8.25, 16.75)));
}

TEST(Pockets, CellsThatShareOnlyAnEdgeOrACornerAreTwoPockets) {
  EXPECT_EQ(find_pockets(solid({6, 6, 6}, {{2, 2, 2}, {3, 2, 2}})).size(), 1U);
  EXPECT_EQ(find_pockets(solid({6, 6, 6}, {{2, 2, 2}, {3, 3, 2}})).size(), 2U);
  EXPECT_EQ(find_pockets(solid({6, 6, 6}, {{2, 2, 2}, {3, 3, 3}})).size(), 2U);
}

TEST(Pockets, AShaftToTheOutsideOpensAPocket) {
  Cells blocked{{3, 3, 3}, {3, 3, 4}, {3, 3, 5}};
  EXPECT_EQ(find_pockets(solid({7, 7, 7}, blocked)).size(), 1U);
  blocked.insert({3, 3, 6});
  EXPECT_TRUE(find_pockets(solid({7, 7, 7}, blocked)).empty());
}

/// Labels of face-connected cells with the same freedom, by repeated sweeps.
std::vector<int> sweep_labels(const VolumeVoxels& voxels) {
  const DistanceBlock& block = voxels.block;
  const Eigen::Vector3i size(block.nx, block.ny, block.nz);
  std::vector<int> label(block.squared.size());
  for (std::size_t i = 0; i < label.size(); ++i) label[i] = static_cast<int>(i);
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < size.prod(); ++i) {
      const Eigen::Vector3i at(i % size.x(), i / size.x() % size.y(), i / size.x() / size.y());
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3i next = at + Eigen::Vector3i::Unit(axis);
        if (next[axis] == size[axis] || is_free(voxels, at) != is_free(voxels, next)) continue;
        int& a = label[block.index(at.x(), at.y(), at.z())];
        int& b = label[block.index(next.x(), next.y(), next.z())];
        changed = changed || a != b;
        a = b = std::min(a, b);
      }
    }
  }
  return label;
}

TEST(Pockets, PocketsAndPartsOfRandomVolumesAreThoseOfRepeatedSweeps) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Dice dice(seed);
    Cells blocked;
    const Eigen::Vector3i size(dice.whole(1, 12), dice.whole(1, 9), dice.whole(1, 11));
    const double share = dice.uniform(0.1, 0.7);
    for (int i = 0; i < size.prod(); ++i) {
      if (dice.uniform(0, 1) < share) {
        blocked.insert({i % size.x(), i / size.x() % size.y(), i / size.x() / size.y()});
      }
    }
    VolumeVoxels voxels = solid(size, blocked);
    const auto label = sweep_labels(voxels);
    std::map<int, std::size_t> pockets, parts;
    for (int z = 0; z < voxels.block.nz; ++z) {
      for (int y = 0; y < voxels.block.ny; ++y) {
        for (int x = 0; x < voxels.block.nx; ++x) {
          const std::size_t i = voxels.block.index(x, y, z);
          ++(is_free(voxels, {x, y, z}) ? parts : pockets)[label[i]];
        }
      }
    }
    pockets.erase(label[voxels.block.index(0, 0, 0)]);
    std::multiset<std::size_t> expected, found;
    for (const auto& [name, count] : pockets) expected.insert(count);
    for (const auto& pocket : find_pockets(voxels)) found.insert(pocket.size());
    EXPECT_EQ(found, expected);
    expected.clear();
    for (const auto& [name, count] : parts) expected.insert(count);
    transform_distances(voxels.block);
    const auto sizes = find_parts(voxels, 0.8).sizes;
    EXPECT_EQ(std::multiset<std::size_t>(sizes.begin(), sizes.end()), expected);
    EXPECT_TRUE(std::is_sorted(sizes.rbegin(), sizes.rend()));
  }
}

/// Two rooms of 11^3 cells and a wall of 3 cells with a square opening between them.
VolumeVoxels two_rooms(int opening) {
  Cells wall;
  for (int x = 11; x < 14; ++x) {
    for (int y = 0; y < 11; ++y) {
      for (int z = 0; z < 11; ++z) {
        const bool open = std::abs(y - 5) <= opening / 2 && std::abs(z - 5) <= opening / 2;
        if (!open || opening == 0) wall.insert({x, y, z});
      }
    }
  }
  VolumeVoxels voxels = solid({25, 11, 11}, wall);
  transform_distances(voxels.block);
  return voxels;
}

TEST(Necks, TheOpeningBetweenTwoRoomsIsANeckOfHalfItsWidth) {
  for (const int opening : {1, 3, 5, 7}) {
    const VolumeVoxels voxels = two_rooms(opening);
    const VolumeParts parts = find_parts(voxels, 0.8);
    ASSERT_EQ(parts.necks.size(), 1U) << opening;
    EXPECT_EQ(parts.necks[0].level, 0.5 * opening);
    EXPECT_EQ(parts.necks[0].smaller, 5.5);
    EXPECT_EQ(parts.necks[0].larger, 5.5);
    const Eigen::Vector3i at = voxels.cell(parts.necks[0].cell) - voxels.first - Eigen::Vector3i::Ones();
    EXPECT_GE(at.x(), 10);
    EXPECT_LE(at.x(), 14);
    EXPECT_EQ(at.y(), 5);
    EXPECT_EQ(at.z(), 5);
    EXPECT_EQ(parts.sizes.size(), 1U);
  }
}

TEST(Necks, AWideOpeningIsNoneAndAClosedWallLeavesTwoParts) {
  EXPECT_TRUE(find_parts(two_rooms(9), 0.8).necks.empty());
  const VolumeParts closed = find_parts(two_rooms(0), 0.8);
  EXPECT_TRUE(closed.necks.empty());
  EXPECT_EQ(closed.sizes, (std::vector<std::size_t>{1331, 1331}));
}

/// Largest level at which `a` and `b` are connected, by flooding at each level.
double widest_way(const VolumeVoxels& voxels, std::size_t a, std::size_t b) {
  double best = 0.0;
  for (const std::uint16_t level :
       std::set<std::uint16_t>(voxels.block.squared.begin(), voxels.block.squared.end())) {
    if (level == 0 || voxels.block.squared[a] < level) continue;
    std::set<std::size_t> seen{a};
    std::vector<std::size_t> open{a};
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      for (const std::ptrdiff_t step : voxels.face_steps()) {
        const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell) + step);
        if (voxels.block.squared[next] >= level && seen.insert(next).second) open.push_back(next);
      }
    }
    if (seen.contains(b)) best = 0.5 * std::sqrt(static_cast<double>(level));
  }
  return best;
}

TEST(Necks, TheNarrowestPlaceOfTheWidestWayIsThatOfFlooding) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Dice dice(seed);
    Cells wall;  // a random slab between two rooms
    for (int x = 9; x < 12; ++x) {
      for (int y = 0; y < 9; ++y) {
        for (int z = 0; z < 9; ++z) {
          if (dice.uniform(0, 1) < 0.35) wall.insert({x, y, z});
        }
      }
    }
    VolumeVoxels voxels = solid({21, 9, 9}, wall);
    transform_distances(voxels.block);
    const double truth = widest_way(voxels, voxels.block.index(5, 5, 5), voxels.block.index(17, 5, 5));
    const VolumeParts parts = find_parts(voxels, 0.8);
    ASSERT_FALSE(parts.necks.empty());
    // The two rooms are the largest parts, so their meeting is the neck with the largest lesser part.
    const auto rooms = std::max_element(parts.necks.begin(), parts.necks.end(),
                                        [](const auto& a, const auto& b) { return a.smaller < b.smaller; });
    EXPECT_EQ(rooms->level, truth);
    EXPECT_EQ(rooms->smaller, 4.5);
  }
}

}  // namespace volume_voxels_test
}  // namespace clearway
