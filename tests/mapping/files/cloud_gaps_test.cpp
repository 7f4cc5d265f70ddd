#include "mapping/files/cloud_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace cloud_gaps_test {

using Points = std::vector<Eigen::Vector3f>;
using Cell = std::tuple<int, int, int>;

Cell cell_of(const Eigen::Vector3d& point) {
  const Eigen::Array3i cell = point.array().floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

/// The definition, asked of all pairs and all voxels; of points of which no two are in a quarter of a voxel.
TEST(CloudGaps, BetweenNearPointsAreThoseThatTheDefinitionNames) {
  Random random(13);
  std::size_t found = 0;
  for (int i = 0; i < 30; ++i) {
    Points points;
    std::vector<Eigen::Vector3i> cells;
    std::set<Cell> held;
    for (int k = 0; k < 400; ++k) {
      Eigen::Vector3d point = random.point(i % 2 == 0 ? 4.0 : 2.5);
      if (i % 2 == 0) point.z() = 0.3 * point.x();
      const bool is_apart = std::none_of(points.begin(), points.end(), [&](const Eigen::Vector3f& other) {
        return (other.cast<double>() - point).norm() < 0.45;
      });
      if (!is_apart) continue;
      points.push_back(point.cast<float>());
      cells.push_back(points.back().cast<double>().array().floor().cast<int>().matrix());
      held.insert({cells.back().x(), cells.back().y(), cells.back().z()});
    }
    std::map<Cell, double> passed;  // the longest way of a join
    for (std::size_t a = 0; a < points.size(); ++a)
      for (std::size_t b = a + 1; b < points.size(); ++b) {
        const Eigen::Vector3d p = points[a].cast<double>(), q = points[b].cast<double>();
        const double apart = (p - q).norm();
        if (apart > 1.95) continue;
        const bool is_empty = std::none_of(points.begin(), points.end(), [&](const Eigen::Vector3f& other) {
          return (other.cast<double>() - (p + q) / 2).norm() < 0.35 * apart;
        });
        if (!is_empty) continue;
        std::map<Cell, double> way;
        for (int s = 0; s < 4000; ++s) way[cell_of(p + s / 4000.0 * (q - p))] += apart / 4000.0;
        for (const auto& [cell, length] : way) {
          const auto [x, y, z] = cell;
          const Eigen::Vector3i at(x, y, z);
          if (std::max((cells[a] - at).cwiseAbs().maxCoeff(), (cells[b] - at).cwiseAbs().maxCoeff()) > 1)
            continue;
          passed[cell] = std::max(passed[cell], length);
        }
      }
    std::set<Cell> between;
    for (const Eigen::Vector3i& cell : cells_between(points, cells, 1.0))
      between.insert({cell.x(), cell.y(), cell.z()});
    found += between.size();
    const auto holds = [&](const Cell& cell, const Eigen::Vector3i& side) {
      const auto [x, y, z] = cell;
      return held.contains({x + side.x(), y + side.y(), z + side.z()});
    };
    const auto is_enclosed = [&](const Cell& cell) {  // by two that face each other
      for (int k = 0; k < 27 * 27; ++k) {
        const auto side = [](int n) { return Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1); };
        const Eigen::Vector3i a = side(k % 27), b = side(k / 27);
        const Eigen::Array3i product = a.array() * b.array();
        if ((product <= 0).all() && product.sum() < 0 && holds(cell, a) && holds(cell, b)) return true;
      }
      return false;
    };
    for (const auto& [cell, length] : passed) {
      if (held.contains(cell) || length <= 0.102 || !is_enclosed(cell)) continue;
      EXPECT_TRUE(between.contains(cell)) << i << " " << length;
    }
    for (const Cell& cell : between) {
      EXPECT_FALSE(held.contains(cell)) << i;
      EXPECT_GT(passed[cell], 0.098) << i;
    }
  }
  EXPECT_GT(found, 300U);
}

/// Nothing lies between the points of dense surfaces, in their corners, or between centres of voxels.
TEST(CloudGaps, OfDenseSurfacesThereAreNone) {
  const auto between = [](const Points& points) {
    std::vector<Eigen::Vector3i> cells;
    for (const Eigen::Vector3f& point : points)
      cells.push_back((point.cast<double>().array() / 0.02).floor().cast<int>().matrix());
    return cells_between(points, cells, 0.02).size();
  };
  Random random(14);
  Points corner, plates, centers;
  for (int i = 0; i < 60'000; ++i) {
    const float a = static_cast<float>(random.unit()), b = static_cast<float>(random.unit());
    corner.push_back({a, b, 0.0031F});
    corner.push_back({a, 0.0029F, b});
    plates.push_back({a, b, 0.0031F});
    plates.push_back({a, b, 0.0431F});
  }
  for (int i = 0; i < 8000; ++i)
    centers.push_back((0.02F * (random.point(9.0).cast<float>().array().round() + 0.5F)).matrix());
  EXPECT_LE(between(corner), 3U);  // of 100 voxels along it
  EXPECT_EQ(between(plates), 0U);
  EXPECT_EQ(between(centers), 0U);
}

}  // namespace cloud_gaps_test
}  // namespace clearway
