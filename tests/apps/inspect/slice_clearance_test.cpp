#include "apps/inspect/slice_clearance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/free_space_map.hpp"

namespace clearway {
namespace slice_clearance_test {

/// One occupied voxel, 0.2 to 0.3 on each axis, and a far one that gives the map its size.
Snapshot two_voxels() {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.35, 0.25, 0.25);
  scan.points = {{-0.1F, 0.0F, 0.0F}, {1.9F, 0.0F, 2.0F}};
  map.insert(scan);
  return map.snapshot();
}

TEST(SliceClearance, LinesLieWhereTheDistanceToTheObstacleIsAMultipleOfTheStep) {
  const Snapshot map = two_voxels();
  SliceCanvas canvas{};
  canvas.right = 0;
  canvas.up = 1;
  canvas.columns = 24;
  canvas.rows = 3;
  canvas.low_right = 0.2;
  canvas.low_up = 0.1;
  canvas.resolution = 0.1;
  canvas.pixels = 20.0;
  constexpr Picture::Colour paper{250, 250, 250};
  Picture image(canvas.width() + 300, canvas.height() + 100, paper);
  const double step = draw_clearance(image, canvas, map, {2, 0.25}, Policy::not_occupied);
  EXPECT_DOUBLE_EQ(step, 0.2);
  const int row = canvas.y(0.25);
  const auto is_line = [&](int x) { return image.at(x, row)[0] > image.at(x, row)[2] + 20; };
  std::vector<double> at;
  for (int x = SliceCanvas::margin_left; x < SliceCanvas::margin_left + canvas.width() - 1; ++x)
    if (is_line(x) && !is_line(x - 1)) at.push_back(canvas.right_at(x));
  for (int line = 1; line < 9; ++line) {
    if (line % 4 == 0) continue;  // may lie under its label
    const auto is_there = [&](double x) { return std::abs(x - 0.3 - step * line) < 0.01; };
    EXPECT_EQ(std::count_if(at.begin(), at.end(), is_there), 1) << "line " << line;
  }
  const int inside = canvas.x(0.25);  // what is blocked has none
  EXPECT_EQ(image.at(inside, row), paper);
}

}  // namespace slice_clearance_test
}  // namespace clearway
