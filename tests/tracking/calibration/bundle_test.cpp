#include "tracking/calibration/bundle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace bundle_test {

TEST(Bundle, derivative_by_the_coefficients_of_a_wide_lens_equals_its_numeric_twin) {
  for (const Camera& camera : {scene::rational_camera(), scene::fisheye_camera()}) {
    const bool is_fisheye = camera.lens == LensDistortion::Model::fisheye;
    for (const Eigen::Vector2d& ray : {Eigen::Vector2d(0.3, -0.2), Eigen::Vector2d(-0.5, 0.1),
                                       Eigen::Vector2d(0.0, 0.4), Eigen::Vector2d(0.0, 0.0)}) {
      const auto by = seen_by_coefficients(camera, ray);
      for (int k = 0; k < kLensUnknowns; ++k) {
        if (is_fisheye && k > 3) {
          EXPECT_TRUE(by.col(k).isZero(0.0));
          continue;
        }
        const auto seen = [&](double step) {
          LensDistortion::Coefficients d = camera.distortion;
          d[static_cast<std::size_t>(k)] += step;
          Eigen::Matrix2d unused;
          return *LensDistortion(d, camera.lens).distort(ray, unused);
        };
        const Eigen::Vector2d numeric = (seen(1e-5) - seen(-1e-5)) / 2e-5;
        EXPECT_LT((numeric - by.col(k)).norm(), 1e-8) << k;
      }
    }
  }
}

TEST(Bundle, priors_of_a_fisheye_shift_its_corner_by_the_stated_distortion) {
  Camera camera = scene::fisheye_camera();
  camera.fx = camera.fy = 300.0;  // 76 degrees in the corners
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion = {};
  camera.errors.distortion = 0.7;
  const auto priors = camera_priors(camera);
  const auto ray = camera.undistort({639.5, 479.5});
  ASSERT_TRUE(ray);
  const auto by = seen_by_coefficients(camera, *ray);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(300.0 * by.col(k).norm() * priors[static_cast<std::size_t>(4 + k)], 0.7, 0.02) << k;
  for (std::size_t k = 8; k < priors.size(); ++k) EXPECT_EQ(priors[k], 0.0);
}

}  // namespace bundle_test
}  // namespace clearway
