#include "apps/pages/map_page.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"

namespace clearway {
namespace map_page_test {

/// A wall of occupied voxels in the plane y = 2, from x = -1 to 1.
Snapshot wall() {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  for (double x = -1.0; x <= 1.0; x += 0.05)
    for (double z = 0.0; z <= 1.0; z += 0.05)
      scan.points.emplace_back(static_cast<float>(x), 2.0F, static_cast<float>(z));
  map.insert(scan, {.max_range = 10.0});
  return map.snapshot();
}

double azimuth_from(const Eigen::Vector3d& from) {
  ReportPage page;
  look_from(page, wall(), from);
  return page.iso_azimuth_deg;
}

/// 0 is from -y, 90 from +x; the eye stands 25 degrees beside.
TEST(MapPage, TheFirstViewIsFromTheSideOfTheWallThatOneStandsOn) {
  EXPECT_NEAR(azimuth_from({0.0, 0.0, 0.0}), 25.0, 2.0);
  EXPECT_NEAR(azimuth_from({4.0, 2.0, 0.0}), 115.0, 2.0);
  EXPECT_NEAR(std::abs(azimuth_from({0.0, 4.0, 0.0})), 205.0, 2.0);
}

TEST(MapPage, TheFirstViewStaysWhereOneIsAmidTheVoxelsOrThereAreNone) {
  EXPECT_EQ(azimuth_from({0.0, 2.05, 0.5}), ReportPage().iso_azimuth_deg);
  ReportPage page;
  look_from(page, FreeSpaceMap({.resolution = 0.1}).snapshot(), {1.0, 2.0, 3.0});
  EXPECT_EQ(page.iso_azimuth_deg, ReportPage().iso_azimuth_deg);
}

}  // namespace map_page_test
}  // namespace clearway
