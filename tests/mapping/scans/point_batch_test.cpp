#include "mapping/scans/point_batch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace point_batch_test {

using worlds::Dice;

TEST(PointBatch, PointsAndCellsAreThoseOfEigenAndTheTreeBitForBit) {
  Dice dice(3);
  std::size_t without_cell = 0;
  for (int round = 0; round < 3000; ++round) {
    const double resolution = dice.uniform(0.001, 0.1);
    const FusedTree tree(resolution);
    const double reach = round % 3 == 0 ? 40000.0 * resolution : 4.0;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (round % 5 != 0) pose.rotate(Eigen::AngleAxisd(dice.uniform(-3.0, 3.0), dice.point(1.0).normalized()));
    pose.translation() = dice.point(1.0);
    std::vector<Eigen::Vector3f> points;
    for (int i = dice.whole(1, 16); i > 0; --i) points.push_back(dice.point(reach).cast<float>());
    if (round % 7 == 0) points.back().y() = std::nanf("");
    if (round % 7 == 1) points.front().z() = -HUGE_VALF;
    if (round % 7 == 2) points.front().x() = 3e38F;
    for (const InstructionSet set : worlds::instruction_sets()) {
      PointBatch batch;
      place_points(points.data(), points.size(), pose, 1.0 / resolution, set, batch);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3f expected = (pose * points[i].cast<double>()).cast<float>();
        const bool finite = expected.allFinite();
        ASSERT_EQ((batch.finite >> i & 1U) != 0, finite);
        if (!finite) {
          ASSERT_EQ(batch.has_cell >> i & 1U, 0U);
          continue;
        }
        ASSERT_EQ(batch.point(i), expected);
        const auto cell = tree.cell(expected.cast<double>());
        ASSERT_EQ((batch.has_cell >> i & 1U) != 0, cell.has_value());
        if (cell) {
          ASSERT_EQ(batch.cell(i), *cell);
        }
        if (!cell) ++without_cell;
      }
      ASSERT_EQ(batch.finite >> points.size(), 0U);
    }
  }
  EXPECT_GT(without_cell, 100U);
}

}  // namespace point_batch_test
}  // namespace clearway
