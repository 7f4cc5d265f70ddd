// Erasing shrinks spheres: what is left never reaches into the eraser, and nothing is lost without need.

#include "mapping/voxels/painted_volume.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace painted_volume_test {

TEST(Shrunk, LeavesASphereThatOnlyTouchesTheEraser) {
  worlds::Dice dice(4);
  int gone = 0, smaller = 0, untouched = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    const double scale = std::pow(10.0, dice.uniform(-3, 3));
    const Sphere sphere{dice.point(scale), dice.uniform(0.01, 1.0) * scale};
    const Sphere eraser{dice.point(scale), dice.uniform(0.01, 1.0) * scale};
    const double distance = (sphere.center - eraser.center).norm();
    const auto left = shrunk(sphere, eraser);
    if (!left) {
      ++gone;
      EXPECT_LE(distance, eraser.radius * (1 + 1e-12) + 1e-12 * scale);
      continue;
    }
    EXPECT_EQ(left->center, sphere.center);
    EXPECT_LE(left->radius, sphere.radius);
    if (left->radius == sphere.radius) {
      ++untouched;
      continue;
    }
    ++smaller;
    EXPECT_LE(left->radius + eraser.radius, distance);
    EXPECT_NEAR(left->radius + eraser.radius, distance, 1e-12 * scale);
  }
  EXPECT_GT(gone, 1000);
  EXPECT_GT(smaller, 1000);
  EXPECT_GT(untouched, 1000);
}

TEST(Shrunk, IsGoneWhenItsCentreIsErased) {
  EXPECT_FALSE(shrunk({{0.0, 0.0, 0.0}, 1.0}, {{0.5, 0.0, 0.0}, 0.6}).has_value());
  EXPECT_FALSE(shrunk({{0.0, 0.0, 0.0}, 1.0}, {{0.0, 0.0, 0.0}, 1e-6}).has_value());
  EXPECT_FALSE(shrunk({{0.0, 0.0, 0.0}, 1.0}, {{0.5, 0.0, 0.0}, 0.5}).has_value());
}

TEST(PaintedVolume, AStrokesTimeSpanIsThatOfItsSpheres) {
  PaintedVolume volume{"v", {}};
  volume.strokes = {{"a", "hand"}, {"b", "hand"}};
  volume.add({{0, 0, 0}, 1.0}, 3.0, 0);
  volume.add({{0, 0, 0}, 1.0}, 7.0, 1);
  volume.add({{0, 0, 0}, 1.0}, 2.0, 0);
  volume.add({{0, 0, 0}, 1.0}, 9.0, -1);
  EXPECT_EQ(volume.strokes[0], (Stroke{"a", "hand", 2.0, 3.0}));
  EXPECT_EQ(volume.strokes[1], (Stroke{"b", "hand", 7.0, 7.0}));
  EXPECT_EQ(volume.stroke(2), &volume.strokes[0]);
  EXPECT_EQ(volume.stroke(3), nullptr);
  EXPECT_EQ((PaintedVolume{"old", {}, {{{0, 0, 0}, 1.0}}, {0.0}}.stroke(0)), nullptr);
}

}  // namespace painted_volume_test
}  // namespace clearway
