// The pixels of a slice, against the state of the voxel at each of them.

#include "apps/inspect/slice_states.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "mapping/free_space_map.hpp"
#include "mapping/maps/hand_edit.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace slice_states_test {

Eigen::Vector3d center(const MapLeaves& map, const SliceFrame& frame, const SlicePlane& plane, int column,
                       int row) {
  Eigen::Vector3d point;
  point[plane.axis] = plane.value;
  point[frame.right] = (frame.low[frame.right] + column + 0.5) * map.resolution();
  point[frame.up] = (frame.low[frame.up] + row + 0.5) * map.resolution();
  return point;
}

TEST(SliceStates, AreThoseOfTheVoxelsInThePlane) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Snapshot snapshot = worlds::random_map(seed).snapshot();
    const MapLeaves map(snapshot);
    worlds::Dice dice(seed);
    for (int axis = 0; axis < 3; ++axis) {
      const SlicePlane plane{axis, dice.uniform(-0.6, 0.6)};
      const SliceFrame frame = slice_frame(map, plane);
      const SlicePixels pixels = slice_pixels(map, plane, 3.0, 2.0);
      ASSERT_EQ(pixels.width, 3 * frame.columns);
      ASSERT_EQ(pixels.height, 2 * frame.rows);
      std::array<std::size_t, 5> counts{};
      for (int row = 0; row < frame.rows; ++row)
        for (int column = 0; column < frame.columns; ++column) {
          const VoxelState state = snapshot.state(center(map, frame, plane, column, row));
          ++counts[static_cast<std::size_t>(std::find(slice_states.begin(), slice_states.end(), state) -
                                            slice_states.begin())];
          for (int k = 0; k < 6; ++k)
            ASSERT_EQ(pixels.at(3 * column + k % 3, pixels.height - 1 - 2 * row - k / 3), state);
        }
      EXPECT_EQ(pixels.counts, counts);
    }
  }
}

TEST(SliceStates, OfVoxelsSmallerThanAPixelAreFreeOnlyWhereAllAre) {
  const Snapshot snapshot = worlds::random_map(7, 0.02).snapshot();
  const MapLeaves map(snapshot);
  const SlicePlane plane{2, 0.1};
  const SliceFrame frame = slice_frame(map, plane);
  const SlicePixels pixels = slice_pixels(map, plane, 0.25, 0.25);
  ASSERT_EQ(pixels.width, (frame.columns + 2) / 4);
  for (int row = 0; row + 1 < pixels.height; ++row)
    for (int column = 0; column + 1 < pixels.width; ++column) {
      std::map<VoxelState, int> count;
      for (int k = 0; k < 16; ++k)
        ++count[snapshot.state(center(map, frame, plane, 4 * column + k % 4, 4 * row + k / 4))];
      const VoxelState blocked =
          count.contains(VoxelState::conflict) ? VoxelState::conflict : VoxelState::occupied;
      const VoxelState expected = count.contains(blocked)            ? blocked
                                  : count[VoxelState::painted] == 16 ? VoxelState::painted
                                  : count[VoxelState::painted] + count[VoxelState::seen_free] == 16
                                      ? VoxelState::seen_free
                                      : VoxelState::unknown;
      EXPECT_EQ(pixels.at(column, pixels.height - 1 - row), expected);
    }
}

TEST(SliceStates, NothingUnknownLooksFreeBesideFreeVoxelsThatTouchItsPixel) {
  FreeSpaceMap fused({.resolution = 0.1});
  const int volume = fused.add_volume("v", {});
  for (int i = 0; i < 300; i += 2) fused.paint(volume, {{0.1 * i + 0.05, 0.05, 0.05}, 0.09}, 0.0);
  const Snapshot snapshot = fused.snapshot();
  const MapLeaves map(snapshot);
  const SlicePlane plane{2, 0.05};
  ASSERT_EQ(snapshot.state({0.05, 0.05, 0.05}), VoxelState::painted);
  ASSERT_EQ(snapshot.state({0.15, 0.05, 0.05}), VoxelState::unknown);
  const double scale = 1400.0 / 1500.0;
  const SlicePixels pixels = slice_pixels(map, plane, scale, 1.0),
                    difference = slice_pixels(map, plane, scale, 1.0, true);
  EXPECT_LE(std::count(pixels.states.begin(), pixels.states.end(), VoxelState::painted), 2);  // at the ends
  EXPECT_GT(std::count(difference.states.begin(), difference.states.end(), VoxelState::painted), 200);
}

/// A room of 64 voxels with a floor and a ceiling, free but for its walls, and a far return with its ray,
/// four voxels thick.
Snapshot room_with_far_return() {
  const auto box = [](const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    std::vector<Eigen::Vector3d> points;
    for (int x = low.x(); x < high.x(); ++x)
      for (int y = low.y(); y < high.y(); ++y)
        for (int z = low.z(); z < high.z(); ++z)
          points.emplace_back(0.1 * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5));
    return points;
  };
  HandEditTally tally;
  Snapshot map = FreeSpaceMap({.resolution = 0.1}).snapshot();
  for (const int z : {0, 32}) map = with_occupied_voxels(map, box({-32, -32, z}, {32, 32, z + 1}), tally);
  map = with_cleared_voxels(map, box({-32, -32, 1}, {32, 32, 32}), tally);
  map = with_cleared_voxels(map, box({32, 0, 4}, {600, 4, 8}), tally);
  return with_occupied_voxels(map, box({600, 1, 5}, {601, 3, 6}), tally);
}

TEST(SliceStates, AFarReturnIsCountedOutsideUnlessTheWholeIsAskedFor) {
  const MapLeaves map(room_with_far_return());
  const SlicePlane part{2, 0.55}, whole{2, 0.55, true};
  const SlicePixels pixels = slice_pixels(map, part, 1.0, 1.0), all = slice_pixels(map, whole, 1.0, 1.0);
  ASSERT_EQ(pixels.width, 70);  // six more than the room, a tenth of it
  EXPECT_EQ(pixels.counts[1], 0U);
  EXPECT_EQ(pixels.counts[3], 64U * 64U + 4U * 6U);
  EXPECT_EQ(pixels.beyond[1], 2U);
  EXPECT_EQ(pixels.beyond[3], 4U * 562U);
  EXPECT_EQ(beyond_text(pixels),
            "2,250 voxels (2 occupied, 2,248 seen free) lie outside; --whole shows them");
  EXPECT_EQ(std::accumulate(pixels.counts.begin(), pixels.counts.end(), std::size_t{0}),
            pixels.states.size());
  EXPECT_EQ(all.width, 633);
  EXPECT_EQ(all.counts[1], 2U);
  EXPECT_EQ(std::count(all.states.begin(), all.states.end(), VoxelState::occupied), 2);
  EXPECT_EQ(beyond_text(all), "");
}

TEST(SliceStates, NothingUnknownLooksFreeAtTheEdgeOfAPictureThatCutsAFreeLeaf) {
  const Snapshot snapshot = room_with_far_return();
  const MapLeaves map(snapshot);
  const SlicePlane plane{2, 0.55};
  const SliceFrame frame = slice_frame(map, plane);
  for (const double scale : {0.3, 0.28, 0.9}) {
    const SlicePixels pixels = slice_pixels(map, plane, scale, scale);
    for (int row = 0; row < frame.rows; ++row)
      for (int column = 0; column < frame.columns; ++column) {
        if (snapshot.state(center(map, frame, plane, column, row)) != VoxelState::unknown) continue;
        const int x = static_cast<int>((column + 0.5) * scale), y = static_cast<int>((row + 0.5) * scale);
        if (x < pixels.width && y < pixels.height) {
          EXPECT_EQ(pixels.at(x, pixels.height - 1 - y), VoxelState::unknown)
              << scale << ' ' << column << ' ' << row;
        }
      }
  }
}

TEST(SliceStates, OfPlanesBesideTheMapAreRefusedWithItsRange) {
  const MapLeaves map(worlds::random_map(1).snapshot());
  for (const double value : {9.0, -9.0, std::numeric_limits<double>::quiet_NaN()}) {
    try {
      require_plane(map, {0, value}, "--slice");
      FAIL() << value;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("which spans"), std::string::npos);
    }
  }
  EXPECT_THROW(require_plane(MapLeaves(FreeSpaceMap({.resolution = 0.1}).snapshot()), {0, 0.0}, "--slice"),
               std::invalid_argument);
}

}  // namespace slice_states_test
}  // namespace clearway
