// Whole scans against stock OctoMap: depth images and lidar turns of a plain room, many in a row, with every
// instruction set and several threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "mapping/scans/scan_rays.hpp"
#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/stock_octomap.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace scan_insertion_test {

using worlds::Dice;
using worlds::expect_equal;
using worlds::insert_stock;

/// Where a ray from inside meets the walls of a room or the pillar in it, with some noise.
Eigen::Vector3f meet_room(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Dice& dice) {
  const Eigen::Array3d wall(2.0, 1.5, 1.2);
  double length = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    const double to_wall = (direction[axis] > 0.0 ? 1.0 : -1.0) * wall[axis] - origin[axis];
    if (direction[axis] != 0.0) length = std::min(length, to_wall / direction[axis]);
  }
  const Eigen::Vector2d along = direction.head<2>(), from = origin.head<2>() - Eigen::Vector2d(0.6, 0.4);
  const double a = along.squaredNorm(), b = along.dot(from), c = from.squaredNorm() - 0.09;
  if (b * b > a * c && b < 0.0) length = std::min(length, (-b - std::sqrt(b * b - a * c)) / a);
  return (direction * (length + dice.uniform(-0.01, 0.01))).cast<float>();
}

/// A depth image of 80 x 60 pixels, or a lidar turn of 16 rings of 300, from a place that moves with `index`.
Scan room_scan(int index, bool lidar) {
  Dice dice(static_cast<unsigned>(index));
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(-0.8 + 0.03 * index, 0.2 * std::sin(0.5 * index), 0.1);
  if (!lidar) scan.map_from_sensor.rotate(Eigen::AngleAxisd(0.1 * index, Eigen::Vector3d::UnitZ()));
  const auto add = [&](const Eigen::Vector3d& direction) {
    const Eigen::Vector3d turned = scan.map_from_sensor.linear() * direction.normalized();
    const Eigen::Vector3f end = meet_room(scan.map_from_sensor.translation(), turned, dice);
    scan.points.push_back((scan.map_from_sensor.linear().transpose() * end.cast<double>()).cast<float>());
  };
  if (lidar) {
    for (int ring = -8; ring < 8; ++ring)
      for (int turn = 0; turn < 300; ++turn)
        add({std::cos(turn * 0.02094), std::sin(turn * 0.02094), 0.04 * ring});
  } else {
    for (int v = -30; v < 30; ++v)
      for (int u = -40; u < 40; ++u) add({1.0, -u / 66.0, -v / 66.0});
  }
  return scan;
}

TEST(ScanInsertion, ScansOfARoomGiveStockOctoMapsTreeWhateverTheInstructionsAndThreads) {
  const int scans = trials(4, 12);
  for (const bool lidar : {false, true}) {
    for (const bool discretize : {false, true}) {
      const double max_range = lidar ? 1.4 : 0.0;
      octomap::OcTree stock(0.04);
      for (int i = 0; i < scans; ++i) insert_stock(stock, room_scan(i, lidar), max_range, discretize);
      std::string first;
      for (const InstructionSet set : worlds::instruction_sets()) {
        for (const int threads : {1, 2, 3}) {
          FusedTree tree(0.04);
          ScanWorkspace workspace;
          ScanInsertion insertion;
          insertion.discretize = discretize;
          insertion.threads = threads;
          insertion.instructions = set;
          for (int i = 0; i < scans; ++i)
            insert_scan(tree, room_scan(i, lidar), {.max_range = max_range}, insertion, workspace);
          expect_equal(stock, tree);
          std::ostringstream bytes;
          tree.writeData(bytes);
          if (first.empty()) first = bytes.str();
          ASSERT_EQ(bytes.str(), first);
        }
      }
    }
  }
}

TEST(ScanInsertion, SharesOfShuffledPointsAreJoinedWithoutLosingOrRepeatingARay) {
  for (const double max_range : {0.0, 1.3}) {
    for (const bool discretize : {false, true}) {
      Dice dice(7);
      Scan scan = room_scan(3, true);
      for (int i = 0; i < 40; ++i)  // beyond the tree: some count by their rays, some are not finite
        scan.points.push_back(i % 2 == 0 ? (5000.0 * dice.point(1.0)).cast<float>().eval()
                                         : Eigen::Vector3f(std::nanf(""), 0.0F, 0.0F));
      std::shuffle(scan.points.begin(), scan.points.end(), std::mt19937(5));
      ScanInsertion insertion;
      insertion.discretize = discretize;
      std::string expected;
      std::size_t rays = 0;
      ScanCounts counts;
      for (const int threads : {1, 2, 5}) {
        insertion.threads = threads;
        FusedTree tree(0.02);
        ScanWorkspace workspace;
        const ScanCounts got = insert_scan(tree, scan, {.max_range = max_range}, insertion, workspace);
        std::ostringstream bytes;
        tree.writeData(bytes);
        if (threads == 1) {
          expected = bytes.str();
          rays = workspace.chosen.ends.size();
          counts = got;
          EXPECT_GT(counts.inserted, 300U);
          EXPECT_EQ(max_range > 0.0, counts.beyond_range > 0);
          EXPECT_GE(counts.dropped_invalid, 20U);
        }
        EXPECT_EQ(bytes.str(), expected);
        EXPECT_EQ(workspace.chosen.ends.size(), rays);
        EXPECT_EQ(got.inserted, counts.inserted);
        EXPECT_EQ(got.beyond_range, counts.beyond_range);
        EXPECT_EQ(got.dropped_invalid, counts.dropped_invalid);
      }
    }
  }
}

TEST(ScanInsertion, RepeatedScansOfARoomClampAndPruneAsStockOctoMapDoes) {
  octomap::OcTree stock(0.05);
  FusedTree tree(0.05);
  ScanWorkspace workspace;
  for (int i = 0; i < 30; ++i) {
    const Scan scan = room_scan(i % 3, false);
    insert_stock(stock, scan, 0.0, i % 2 == 0);
    ScanInsertion insertion;
    insertion.discretize = i % 2 == 0;
    insert_scan(tree, scan, {}, insertion, workspace);
    if (i % 10 == 9) expect_equal(stock, tree);
  }
}

}  // namespace scan_insertion_test
}  // namespace clearway
