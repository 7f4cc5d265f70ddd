#include "tracking/camera.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace camera_test {

TEST(Camera, projects_as_opencv_does_for_random_points_and_distortions) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    Camera camera = scene::plain_camera();
    camera.distortion = {0.1 * unit(random), 0.03 * unit(random), 0.002 * unit(random), 0.002 * unit(random),
                         0.01 * unit(random)};
    const Eigen::Vector3d point(0.45 * unit(random), 0.35 * unit(random), 1.0 + 0.2 * unit(random));
    const auto pixel = camera.project(point);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - scene::pixel_by_opencv(camera, point)).norm(), 1e-9);
  }
}

TEST(Camera, undistort_and_project_are_inverse_over_the_whole_image) {
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera()})
    for (double x = -0.5; x < camera.width; x += 20)
      for (double y = -0.5; y < camera.height; y += 20) {
        const auto ray = camera.undistort({x, y});
        ASSERT_TRUE(ray);
        const auto back = camera.project(2.5 * ray->homogeneous());
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Eigen::Vector2d(x, y)).norm(), 1e-9);
      }
}

TEST(Camera, derivative_of_the_pixel_equals_its_numeric_twin) {
  const Camera camera = scene::distorted_camera();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point(0.4 * unit(random), 0.3 * unit(random), 0.9 + 0.1 * unit(random));
    Eigen::Matrix<double, 2, 3> derivative;
    ASSERT_TRUE(camera.project(point, derivative));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d numeric = (*camera.project(point + h) - *camera.project(point - h)) / 2e-6;
      EXPECT_LT((numeric - derivative.col(k)).norm(), 1e-4);
    }
  }
}

TEST(Camera, sees_nothing_behind_it_at_it_or_at_infinity) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(nan, 0, 1),
        Eigen::Vector3d(0, inf, 1), Eigen::Vector3d(0, 0, inf)})
    EXPECT_FALSE(scene::distorted_camera().project(point));
  EXPECT_FALSE(scene::distorted_camera().undistort({nan, 0}));
  EXPECT_FALSE(scene::distorted_camera().undistort({0, inf}));
}

TEST(Camera, refuses_rays_beyond_the_fold_of_its_distortion_even_where_the_formula_falls_on_the_image) {
  Camera camera = scene::plain_camera();
  camera.distortion = {-0.3, 0.0, 0.0, 0.0, 0.0};  // r (1 - 0.3 r^2) grows up to r = 1.0541
  const double fold = std::sqrt(1.0 / 0.9);
  EXPECT_TRUE(camera.project({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(camera.project({fold + 1e-6, 0, 1}));
  EXPECT_FALSE(camera.project({1.8, 0, 1}));  // the formula gives x = 348: on the image
  EXPECT_FALSE(camera.undistort({camera.cx + 600.0, camera.cy}));
}

TEST(Camera, finds_the_smallest_fold_of_any_radial_polynomial) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    Camera camera = scene::plain_camera();
    camera.distortion = {unit(random), i % 3 ? unit(random) : 0.0, 0.0, 0.0, i % 2 ? unit(random) : 0.0};
    const auto& d = camera.distortion;
    double fold = 3.0;  // by walking outwards
    for (double r = 0.0; r < 3.0; r += 1e-3) {
      const double s = r * r;
      if (1 + 3 * d[0] * s + 5 * d[1] * s * s + 7 * d[4] * s * s * s <= 0) {
        fold = r;
        break;
      }
    }
    EXPECT_TRUE(camera.project({0.98 * fold, 0, 1})) << i;
    if (fold < 3.0) {
      EXPECT_FALSE(camera.project({fold + 2e-3, 0, 1})) << i;
    }
  }
}

TEST(Camera, refuses_each_field_out_of_its_range_and_names_it) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<const char*, std::function<void(Camera&)>> faults[] = {
      {"width", [](Camera& c) { c.width = 0; }},
      {"height", [](Camera& c) { c.height = 31; }},
      {"width", [](Camera& c) { c.width = 1 << 20; }},
      {"fx", [](Camera& c) { c.fx = 0; }},
      {"fy", [&](Camera& c) { c.fy = nan; }},
      {"cx", [](Camera& c) { c.cx = -1; }},
      {"cy", [](Camera& c) { c.cy = 480; }},
      {"cx", [&](Camera& c) { c.cx = nan; }},
      {"distortion", [&](Camera& c) { c.distortion[2] = nan; }},
      {"distortion", [](Camera& c) { c.distortion[0] = -3.0; }}};  // folds inside the image
  EXPECT_NO_THROW(scene::plain_camera().validate());
  EXPECT_NO_THROW(scene::distorted_camera().validate());
  for (const auto& [field, spoil] : faults) {
    Camera camera = scene::distorted_camera();
    spoil(camera);
    try {
      camera.validate();
      ADD_FAILURE() << field;
    } catch (const std::invalid_argument& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(field), std::string::npos) << refusal.what();
    }
  }
}

TEST(Camera, sees_up_to_the_outer_edge_of_the_border_pixels) {
  const Camera camera = scene::plain_camera();
  EXPECT_TRUE(camera.sees({-0.5, -0.5}));
  EXPECT_TRUE(camera.sees({639.5, 479.5}));
  EXPECT_FALSE(camera.sees({-0.6, 0}));
  EXPECT_FALSE(camera.sees({1.0, 100}, 2.0));
}

}  // namespace camera_test
}  // namespace clearway
