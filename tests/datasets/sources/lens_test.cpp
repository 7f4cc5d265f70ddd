#include "datasets/sources/lens.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

namespace clearway {
namespace lens_test {

const CameraIntrinsics camera{640, 480, 700, 702, 322.5, 238, {-0.12, 0.05, 0.0005, -0.0004, 0.01}};

TEST(Lens, ProjectsAsOpenCvDoes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(uniform(random), uniform(random), 1 + uniform(random));
  std::vector<cv::Point2d> pixels;
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, camera.distortion, pixels);
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d ours = project(camera, {points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(ours.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(ours.y(), pixels[i].y, 1e-9);
  }
}

TEST(Lens, TheRayOfEveryPixelProjectsBackToIt) {
  for (int row = -1; row <= 480; row += 13) {
    for (int column = -1; column <= 640; column += 11) {
      const Eigen::Vector2d pixel(column, row);
      EXPECT_LT((project(camera, pixel_ray(camera, pixel)) - pixel).norm(), 1e-9);
    }
  }
}

TEST(Lens, AFoldedLensStillGivesANumber) {
  CameraIntrinsics folded = camera;
  folded.distortion = {-3, 0, 0, 0, 0};
  EXPECT_TRUE(pixel_ray(folded, {0, 0}).allFinite());
}

}  // namespace lens_test
}  // namespace clearway
