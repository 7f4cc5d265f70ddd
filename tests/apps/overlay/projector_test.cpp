#include "apps/overlay/projector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace projector_test {

using namespace clearway;
using Eigen::Vector3d;

/// A wide lens with all five coefficients, whose polynomial folds soon after the image's corner.
Camera wide_camera() { return {640, 480, 330.0, 332.0, 318.0, 242.0, {-0.28, 0.07, 0.001, -0.0008, -0.006}}; }

/// Folds at a radius of 1.54, which is seen 12 pixels beyond the image's corner.
Camera folding_camera() { return {640, 480, 400.0, 400.0, 319.5, 239.5, {-0.14, 0.0, 0.0, 0.0, 0.0}}; }

Vector3d drawn_point(std::mt19937& random) {
  std::uniform_real_distribution<double> aside(-0.9, 0.9), ahead(0.05, 4.0);
  const double z = ahead(random);
  return {aside(random) * z, 0.75 * aside(random) * z, z};
}

double along(const Eigen::Vector2d& p, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return (p - from).dot(to - from) / (to - from).squaredNorm();
}

/// Distance of a pixel from a polyline.
double distance_to(const std::vector<std::array<ScreenCorner, 2>>& pieces, const Eigen::Vector2d& p) {
  double least = 1e9;
  for (const auto& [a, b] : pieces) {
    const Eigen::Vector2d from(a.x, a.y), to(b.x, b.y);
    const double share = std::clamp(along(p, from, to), 0.0, 1.0);
    least = std::min(least, (from + share * (to - from) - p).norm());
  }
  return least;
}

TEST(Projector, sees_points_where_opencv_projects_them) {
  std::mt19937 random(1);
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera(), wide_camera(),
                               scene::rational_camera(), scene::fisheye_camera()}) {
    const Projector projector(camera);
    for (int i = 0; i < 2000; ++i) {
      const Vector3d point = drawn_point(random);
      const auto pixel = projector.pixel(point);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - scene::pixel_by_opencv(camera, point)).norm(), 1e-6);
    }
  }
}

TEST(Projector, sees_nothing_behind_the_near_plane_or_beyond_the_fold) {
  const Projector projector(folding_camera(), {.near = 0.1});
  EXPECT_FALSE(projector.pixel({0, 0, 0.0999}));
  EXPECT_FALSE(projector.pixel({0, 0, -1}));
  EXPECT_FALSE(projector.pixel({0, 0, std::nan("")}));
  EXPECT_TRUE(projector.pixel({0, 0, 0.1}));
  // d/dr (r - 0.14 r^3) = 0
  const double fold = std::sqrt(1.0 / 0.42);
  EXPECT_TRUE(projector.pixel({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(projector.pixel({fold + 1e-6, 0, 1}));
  EXPECT_FALSE(projector.pixel({0, 5.0, 1}));  // where the formula gives a pixel of the image again
}

TEST(Projector, segments_follow_the_lens) {
  std::mt19937 random(2);
  int seen = 0;
  for (const Camera& camera : {scene::distorted_camera(), wide_camera(), folding_camera(),
                               scene::rational_camera(), scene::fisheye_camera()}) {
    const Projector projector(camera, {.tolerance = 0.25});
    for (int i = 0; i < 300; ++i) {
      const Vector3d from = drawn_point(random), to = drawn_point(random);
      const auto pieces = projector.segment(from, to);
      for (int k = 0; k <= 50; ++k) {
        const Vector3d point = from + (to - from) * (k / 50.0);
        const auto pixel = projector.pixel(point);
        if (!pixel || !camera.sees(*pixel)) continue;
        ++seen;
        EXPECT_LT(distance_to(pieces, *pixel), 0.26);
      }
    }
  }
  EXPECT_GT(seen, 10000);
}

TEST(Projector, what_is_drawn_of_a_segment_through_the_camera_is_before_it) {
  std::mt19937 random(3);
  std::normal_distribution<double> any(0.0, 1.0);
  for (const Camera& camera :
       {scene::plain_camera(), wide_camera(), folding_camera(), scene::fisheye_camera()}) {
    const Projector projector(camera, {.near = 0.05});
    for (int i = 0; i < 1000; ++i) {
      const Vector3d from(any(random), any(random), any(random)), to(any(random), any(random), any(random));
      for (const auto& piece : projector.segment(from, to))
        for (const ScreenCorner& corner : piece) {
          EXPECT_GT(corner.inverse_depth, 0.0F);
          EXPECT_LE(corner.inverse_depth, static_cast<float>(1.0 / 0.05) * 1.00001F);
          EXPECT_LT(std::abs(corner.x), 10000.0F);
          EXPECT_LT(std::abs(corner.y), 10000.0F);
        }
    }
  }
}

TEST(Projector, a_straight_edge_across_a_fisheye_bends_with_it) {
  const Camera camera = scene::fisheye_camera();
  const Projector projector(camera);
  const Vector3d from(-20, 0.8, 0.4), to(20, 0.8, 0.4);
  const auto pieces = projector.segment(from, to);
  EXPECT_GT(pieces.size(), 8U);
  EXPECT_LT(pieces.size(), 200U);
  int seen = 0;
  for (double x = -20; x <= 20; x += 0.05) {
    const Eigen::Vector2d pixel = scene::pixel_by_opencv(camera, {x, 0.8, 0.4});
    if (!camera.sees(pixel)) continue;
    ++seen;
    EXPECT_LT(distance_to(pieces, pixel), 0.26) << x;
  }
  EXPECT_GT(seen, 130);
  // The chord of its ends is far from it.
  const Eigen::Vector2d middle = scene::pixel_by_opencv(camera, {0, 0.8, 0.4});
  EXPECT_GT(middle.y() - scene::pixel_by_opencv(camera, from).y(), 200.0);
}

/// And the two parts of a triangle that is cut from one corner cover the same.
TEST(Projector, pieces_of_triangles_cover_the_image_of_the_triangle_once) {
  std::mt19937 random(4);
  int seen = 0;
  for (const Camera& camera : {scene::distorted_camera(), wide_camera(), folding_camera(),
                               scene::rational_camera(), scene::fisheye_camera()}) {
    const Projector projector(camera);
    for (int i = 0; i < 100; ++i) {
      const Vector3d a = drawn_point(random), b = drawn_point(random), c = drawn_point(random);
      const auto is_seen = [&](const Vector3d& p) { return camera.sees(*projector.pixel(p), 30.0); };
      if (!is_seen(a) || !is_seen(b) || !is_seen(c)) continue;  // what lies beside the image may be left out
      ++seen;
      double area = 0.0, halves = 0.0;
      const auto add = [](double& sum) {
        return [&sum](const ScreenTriangle& t) {
          sum += std::abs((t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[2].x - t[0].x) * (t[1].y - t[0].y));
        };
      };
      const Vector3d middle = 0.3 * a + 0.7 * b;
      projector.triangle({CameraCorner{a}, {b}, {c}}, add(area));
      projector.triangle({CameraCorner{a}, {middle}, {c}}, add(halves));
      projector.triangle({CameraCorner{middle}, {b}, {c}}, add(halves));
      EXPECT_NEAR(area, halves, 2.0 * 0.25 * 2000.0);  // twice the area: a quarter of a pixel along its edges
    }
  }
  EXPECT_GT(seen, 50);
}

TEST(Projector, refuses_options_and_cameras_that_make_no_sense) {
  EXPECT_THROW(Projector(scene::plain_camera(), {.near = 0.0}), std::invalid_argument);
  EXPECT_THROW(Projector(scene::plain_camera(), {.tolerance = 0.0}), std::invalid_argument);
  Camera camera = scene::plain_camera();
  camera.fx = -1.0;
  EXPECT_THROW(Projector{camera}, std::invalid_argument);
}

}  // namespace projector_test
