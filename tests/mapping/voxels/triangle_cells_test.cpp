#include "mapping/voxels/triangle_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

namespace clearway {
namespace triangle_cells_test {

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Eigen::Vector3d point(double reach) {
    return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
  }

 private:
  std::mt19937 random_;
};

TEST(TriangleCells, AreEachOnceExactlyThoseWhoseCubesMeetTheTriangle) {
  Draw draw(3);
  for (int round = 0; round < 40; ++round) {
    const Triangle triangle{draw.point(1.0), draw.point(1.0), draw.point(1.0)};
    const double edge = draw.between(0.05, 0.4);
    std::set<std::array<int, 3>> cells;
    visit_cells_met(triangle, edge, [&](const Eigen::Vector3i& cell) {
      EXPECT_TRUE(cells.insert({cell.x(), cell.y(), cell.z()}).second);
    });
    const int reach = static_cast<int>(1.0 / edge) + 2;
    std::size_t met = 0;
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          const Eigen::Vector3d center = edge * (Eigen::Vector3d(x, y, z).array() + 0.5);
          const bool meets = triangle_meets_box(triangle, center, Eigen::Vector3d::Constant(0.5 * edge));
          EXPECT_EQ(meets, cells.contains({x, y, z}));
          met += meets;
        }
    EXPECT_EQ(met, cells.size());
  }
}

TEST(TriangleCells, HoldEveryPointOfTheTriangle) {
  Draw draw(5);
  for (int round = 0; round < 30; ++round) {
    const Triangle triangle{draw.point(3.0), draw.point(3.0), draw.point(0.2)};
    const double edge = draw.between(0.02, 0.2);
    std::set<std::array<int, 3>> cells;
    visit_cells_met(triangle, edge, [&](const Eigen::Vector3i& cell) {
      cells.insert({cell.x(), cell.y(), cell.z()});
    });
    for (int i = 0; i < 5000; ++i) {
      double u = draw.between(0.0, 1.0), v = draw.between(0.0, 1.0);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Eigen::Vector3d point =
          triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
      const Eigen::Vector3i cell = (point.array() / edge).floor().cast<int>();
      EXPECT_TRUE(cells.contains({cell.x(), cell.y(), cell.z()})) << point.transpose();
    }
  }
}

TEST(TriangleCells, AFaceInTheBorderOfTwoLayersMeetsBothAndAPointIsATriangle) {
  std::set<int> layers;
  visit_cells_met({Eigen::Vector3d(0.01, 0.01, 0.1), {0.39, 0.01, 0.1}, {0.01, 0.39, 0.1}}, 0.1,
                  [&](const Eigen::Vector3i& cell) { layers.insert(cell.z()); });
  EXPECT_EQ(layers, (std::set<int>{0, 1}));
  int cells = 0;
  const Eigen::Vector3d point(0.25, -0.31, 7.77);
  visit_cells_met({point, point, point}, 0.1, [&](const Eigen::Vector3i& cell) {
    ++cells;
    EXPECT_EQ(cell, Eigen::Vector3i(2, -4, 77));
  });
  EXPECT_EQ(cells, 1);
}

}  // namespace triangle_cells_test
}  // namespace clearway
