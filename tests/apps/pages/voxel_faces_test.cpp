#include "apps/pages/voxel_faces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

namespace clearway {
namespace voxel_faces_test {

using Cell = std::array<int, 3>;
using Face = std::array<int, 4>;  // direction, then the voxel that owns the face

constexpr double kSize = 0.05;

void add_leaf(PageVoxels& voxels, const Cell& low, int side) {
  Eigen::Vector3d center;
  for (int a = 0; a < 3; ++a) center[a] = (low[static_cast<std::size_t>(a)] + 0.5 * side) * voxels.size;
  voxels.add(center, side * voxels.size);
}

std::set<Cell> cells_of(const Cell& low, int side) {
  std::set<Cell> cells;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z) cells.insert({low[0] + x, low[1] + y, low[2] + z});
  return cells;
}

/// Every face between a cell of the set and one outside, from the definition.
std::set<Face> faces_by_definition(const std::set<Cell>& cells) {
  std::set<Face> faces;
  for (const Cell& cell : cells)
    for (int direction = 0; direction < 6; ++direction) {
      Cell beside = cell;
      beside[direction / 2] += direction % 2 == 1 ? 1 : -1;
      if (!cells.contains(beside)) faces.insert({direction, cell[0], cell[1], cell[2]});
    }
  return faces;
}

/// The single faces that the quads cover; a face covered twice fails the test.
std::set<Face> faces_of(const std::vector<VoxelQuad>& quads) {
  std::set<Face> faces;
  for (const VoxelQuad& quad : quads)
    for (std::uint32_t i = 0; i < quad.width; ++i)
      for (std::uint32_t j = 0; j < quad.height; ++j) {
        const int axis = quad.direction / 2;
        Face face{quad.direction};
        face[1 + axis] = quad.layer - kOriginVoxel;
        face[1 + (axis + 1) % 3] = quad.u + static_cast<int>(i) - kOriginVoxel;
        face[1 + (axis + 2) % 3] = quad.v + static_cast<int>(j) - kOriginVoxel;
        EXPECT_TRUE(faces.insert(face).second) << "a face is covered twice";
      }
  return faces;
}

/// Random leaves of 1 to 8 voxels, aligned and disjoint, around the origin.
std::pair<PageVoxels, std::set<Cell>> random_leaves(std::mt19937_64& random, int tries) {
  PageVoxels voxels{"occupied", kSize};
  std::set<Cell> all;
  for (int k = 0; k < tries; ++k) {
    const int side = 1 << (random() % 4);
    Cell low;
    for (int& c : low) c = (static_cast<int>(random() % 16) - 8) / side * side;
    const std::set<Cell> cells = cells_of(low, side);
    bool free = true;
    for (const Cell& cell : cells) free = free && !all.contains(cell);
    if (!free) continue;
    all.insert(cells.begin(), cells.end());
    add_leaf(voxels, low, side);
  }
  return {voxels, all};
}

TEST(VoxelFaces, AreTheFacesOfTheDefinitionForRandomLeavesOfSeveralSizes) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    const auto [voxels, cells] = random_leaves(random, 1 + static_cast<int>(random() % 150));
    EXPECT_EQ(faces_of(exposed_faces(voxels)), faces_by_definition(cells));
    EXPECT_EQ(voxels.count, cells.size());
  }
}

TEST(VoxelFaces, DoNotDependOnTheOrderOfTheLeaves) {
  std::mt19937_64 random(12);
  for (int round = 0; round < 20; ++round) {
    const auto [voxels, cells] = random_leaves(random, 100);
    PageVoxels sorted{"occupied", kSize}, reversed{"occupied", kSize};
    for (const Cell& cell : cells) add_leaf(sorted, cell, 1);
    for (auto cell = cells.rbegin(); cell != cells.rend(); ++cell) add_leaf(reversed, *cell, 1);
    EXPECT_EQ(exposed_faces(reversed), exposed_faces(sorted));
    EXPECT_EQ(faces_of(exposed_faces(sorted)), faces_of(exposed_faces(voxels)));
  }
}

/// The cells of twice the edge of which any or all voxels are in the set, from the definition.
std::set<Cell> coarse_cells(const std::set<Cell>& cells, bool any) {
  std::map<Cell, int> inside;
  for (const Cell& cell : cells) {
    Cell low{};
    for (std::size_t a = 0; a < 3; ++a) low[a] = (cell[a] - (cell[a] & 1));
    ++inside[low];
  }
  std::set<Cell> result;
  for (const auto& [low, voxels] : inside) {
    if (!any && voxels < 8) continue;
    const std::set<Cell> all = cells_of(low, 2);
    result.insert(all.begin(), all.end());
  }
  return result;
}

TEST(VoxelFaces, OfCoarserCellsAreThoseOfTheirDefinition) {
  std::mt19937_64 random(13);
  for (int round = 0; round < 200; ++round) {
    auto [voxels, cells] = random_leaves(random, 1 + static_cast<int>(random() % 150));
    voxels.cells.sort();
    const bool any = random() % 2 == 0;
    voxels.cells.coarsen(any);
    std::set<Cell> coarse = coarse_cells(cells, any);
    EXPECT_EQ(faces_of(exposed_faces(voxels)), faces_by_definition(coarse));
    if (random() % 2 == 0) continue;
    voxels.cells.coarsen(any);  // and again: cells of 4 voxels
    std::map<Cell, int> inside;
    for (const Cell& cell : cells) ++inside[{cell[0] & ~3, cell[1] & ~3, cell[2] & ~3}];
    coarse.clear();
    for (const auto& [low, count] : inside)
      if (any || count == 64) coarse.merge(cells_of(low, 4));
    EXPECT_EQ(faces_of(exposed_faces(voxels)), faces_by_definition(coarse));
  }
}

TEST(VoxelFaces, AreCountedWithoutBeingMade) {
  std::mt19937_64 random(14);
  for (int round = 0; round < 50; ++round) {
    const auto [voxels, cells] = random_leaves(random, 100);
    PageVoxels single{"occupied", kSize};
    for (const Cell& cell : cells) add_leaf(single, cell, 1);
    single.cells.sort();
    EXPECT_EQ(count_faces(single.cells), faces_by_definition(cells).size());
  }
}

TEST(VoxelFaces, OfASolidBlockAreSixRectanglesHoweverItIsCutIntoLeaves) {
  PageVoxels whole{"painted", kSize}, pieces{"painted", kSize};
  add_leaf(whole, {-8, 0, 8}, 8);
  for (const Cell& cell : cells_of({-8, 0, 8}, 8)) add_leaf(pieces, cell, 1);
  EXPECT_EQ(exposed_faces(whole).size(), 6U);
  EXPECT_EQ(exposed_faces(pieces), exposed_faces(whole));
}

TEST(VoxelFaces, OfALargeLeafCostNoMoreThanItsSurface) {
  PageVoxels voxels{"seen_free", kSize};
  add_leaf(voxels, {0, 0, 0}, 16384);
  add_leaf(voxels, {-1, 0, 0}, 1);
  // The small cube splits the large one's -x face into a quadtree, and hides its own +x face.
  const auto quads = exposed_faces(voxels);
  EXPECT_LT(quads.size(), 60U);
  std::uint64_t area = 0;
  for (const VoxelQuad& quad : quads) area += std::uint64_t{quad.width} * quad.height;
  EXPECT_EQ(area, 6 * std::uint64_t{16384} * 16384 + 6 - 2);
}

TEST(VoxelFaces, AtTheEdgeOfTheOctreesSpaceAreExposed) {
  PageVoxels corners{"occupied", 1.0}, whole{"occupied", 1.0};
  add_leaf(corners, {-32768, -32768, -32768}, 1);
  add_leaf(corners, {32767, 32767, 32767}, 1);
  EXPECT_EQ(exposed_faces(corners).size(), 12U);
  add_leaf(whole, {-32768, -32768, -32768}, 65536);
  const auto quads = exposed_faces(whole);
  ASSERT_EQ(quads.size(), 6U);
  EXPECT_EQ(quads[0].width, 65536U);
}

TEST(VoxelFaces, OfAnEmptySetAreNone) { EXPECT_TRUE(exposed_faces({"occupied", kSize}).empty()); }

TEST(VoxelFaces, RefuseLeavesThatNoOctreeHolds) {
  const auto refused = [](Cell low, double side, double shift) {
    PageVoxels voxels{"occupied", kSize};
    add_leaf(voxels, {0, 0, 0}, 4);
    Eigen::Vector3d center(low[0] + 0.5 * side + shift, low[1] + 0.5 * side, low[2] + 0.5 * side);
    EXPECT_THROW(
        {
          voxels.add(center * kSize, side * kSize);
          exposed_faces(voxels);
        },
        std::invalid_argument);
  };
  refused({1, 2, 3}, 1, 0);      // inside the other leaf
  refused({6, 8, 8}, 4, 0);      // not aligned to its edge
  refused({8, 8, 8}, 3, 0);      // not a power of two
  refused({8, 8, 8}, 1, 0.5);    // between two voxels
  refused({40000, 0, 0}, 1, 0);  // outside the space
  refused({0, 0, 0}, 8, 0);      // around the other leaf
  refused({8, 8, 8}, std::numeric_limits<double>::quiet_NaN(), 0);
  refused({8, 8, 8}, 1, std::numeric_limits<double>::quiet_NaN());
  PageVoxels no_size{"occupied", 0.0};
  EXPECT_THROW(no_size.add(Eigen::Vector3d::Zero(), 1.0), std::invalid_argument);
}

}  // namespace voxel_faces_test
}  // namespace clearway
