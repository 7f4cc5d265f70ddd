#pragma once

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "mapping/scans/scan.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::worlds {

/// Inserts a scan with octomap::OcTree::insertPointCloud; max_range 0 is none, as in ScanFilter.
inline void insert_stock(octomap::OcTree& tree, const Scan& scan, double max_range, bool discretize) {
  octomap::Pointcloud cloud;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
    cloud.push_back(at.x(), at.y(), at.z());
  }
  const Eigen::Vector3f origin = scan.map_from_sensor.translation().cast<float>();
  tree.insertPointCloud(cloud, {origin.x(), origin.y(), origin.z()}, max_range > 0.0 ? max_range : -1.0,
                        false, discretize);
}

/// Node for node and log-odds for log-odds; also that our tree counts its nodes rightly.
inline void expect_equal(const octomap::OcTree& stock, const FusedTree& fused) {
  ASSERT_EQ(stock.size(), fused.size());
  ASSERT_EQ(fused.calcNumNodes(), fused.size());
  if (stock.size() == 0) return;
  auto it = fused.begin_tree();
  for (auto expected = stock.begin_tree(), end = stock.end_tree(); expected != end; ++expected, ++it) {
    ASSERT_EQ(it.getKey(), expected.getKey());
    ASSERT_EQ(it.getDepth(), expected.getDepth());
    ASSERT_EQ(it->getLogOdds(), expected->getLogOdds());
    ASSERT_TRUE(it->observed());
  }
}

}  // namespace clearway::worlds
