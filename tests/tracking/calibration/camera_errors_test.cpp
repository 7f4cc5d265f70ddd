#include "tracking/calibration/camera_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/calibration/bundle.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace camera_errors_test {

/// Of views of the middle of the image: centre and tangential distortion, focal length and k1 are known
/// together alone.
Eigen::MatrixXd drawn_covariance(const Camera& camera, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kSharedUnknowns, kSharedUnknowns);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d ray(0.2 * unit(random), 0.2 * unit(random), 1.0);
    const Eigen::MatrixXd by = pixel_by_camera(camera, ray);
    information += transposed_product(by, by);
  }
  for (int i = 0; i < kSharedUnknowns; ++i) information(i, i) += i < 4 ? 1e-9 : 1.0;
  return Cholesky(information).inverse();
}

TEST(CameraErrors, move_each_outer_part_of_the_image_as_the_covariance_does_or_more) {
  const Camera camera = scene::distorted_camera();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Eigen::MatrixXd covariance = drawn_covariance(camera, seed);
    Camera found = camera;
    found.errors = errors_of(camera, covariance);
    const std::array<double, 4> corners = corner_errors(camera, covariance);
    const Eigen::Vector2d pixels[] = {{-0.5, -0.5},
                                      {camera.width - 0.5, -0.5},
                                      {camera.width - 0.5, camera.height - 0.5},
                                      {-0.5, camera.height - 0.5}};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GT(corners[i], 0.0) << seed;
      EXPECT_LE(corners[i], found.shift_by_errors(pixels[i]).norm() + 1e-9) << seed << " " << i;
    }
  }
}

}  // namespace camera_errors_test
}  // namespace clearway
