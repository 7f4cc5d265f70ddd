#include "tracking/lens_distortion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace lens_distortion_test {

using Model = LensDistortion::Model;

/// Of real size, and such that they may fold.
LensDistortion::Coefficients drawn(Model model, std::mt19937& random, double size) {
  std::uniform_real_distribution<double> unit(-size, size);
  LensDistortion::Coefficients d{};
  const int count = model == Model::fisheye ? 4 : 8;
  for (int i = 0; i < count; ++i) d[static_cast<std::size_t>(i)] = unit(random);
  if (model != Model::fisheye) d[2] *= 0.01, d[3] *= 0.01;
  return d;
}

TEST(LensDistortion, projects_as_opencv_does) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    Camera camera = scene::plain_camera();
    camera.lens = i % 2 ? Model::fisheye : Model::rational;
    camera.distortion = drawn(camera.lens, random, 0.1);
    const double spread = i % 2 ? 4.0 : 0.8;  // a fisheye to 80 degrees
    const Eigen::Vector3d point(spread * unit(random), spread * unit(random), 1.0 + 0.2 * unit(random));
    const auto pixel = camera.project(point);
    if (!pixel) continue;  // beyond the fold
    ++seen;
    EXPECT_LT((*pixel - scene::pixel_by_opencv(camera, point)).norm(), 1e-9);
  }
  EXPECT_GT(seen, 3000);
}

TEST(LensDistortion, undistorts_as_opencv_does) {
  for (const Camera& camera : {scene::rational_camera(), scene::fisheye_camera()}) {
    const bool is_fisheye = camera.lens == Model::fisheye;
    const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    const cv::Mat d(1, is_fisheye ? 4 : 8, CV_64F, const_cast<double*>(camera.distortion.data()));
    for (double x = 30; x < camera.width; x += 20)
      for (double y = 5; y < camera.height; y += 20) {
        const std::vector<cv::Point2d> pixel{{x, y}};
        std::vector<cv::Point2d> theirs;
        const cv::TermCriteria exact(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-14);
        if (is_fisheye)
          cv::fisheye::undistortPoints(pixel, theirs, matrix, d);
        else
          cv::undistortPoints(pixel, theirs, matrix, d, cv::noArray(), cv::noArray(), exact);
        const auto ours = camera.undistort({x, y});
        if (!ours) {  // only a fisheye's corners look sideways
          EXPECT_TRUE(is_fisheye && std::hypot(x - camera.cx, y - camera.cy) > 340.0) << x << " " << y;
          continue;
        }
        const double scale = 1.0 + ours->squaredNorm();  // OpenCV stops at 1e-8 radians
        EXPECT_LT((*ours - Eigen::Vector2d(theirs[0].x, theirs[0].y)).norm() / scale, 1e-7) << x << " " << y;
      }
  }
}

TEST(LensDistortion, undistort_and_project_are_inverse_wherever_there_is_a_ray) {
  std::mt19937 random(5);
  int rays = 0;
  for (int i = 0; i < 200; ++i) {
    Camera camera = i % 2 ? scene::fisheye_camera() : scene::rational_camera();
    if (i > 1) camera.distortion = drawn(camera.lens, random, 0.15);
    for (double x = -0.5; x < camera.width; x += 40)
      for (double y = -0.5; y < camera.height; y += 40) {
        const auto ray = camera.undistort({x, y});
        if (!ray) continue;
        ++rays;
        const auto back = camera.project(2.5 * ray->homogeneous());
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Eigen::Vector2d(x, y)).norm(), 1e-8);
      }
  }
  EXPECT_GT(rays, 200 * 150);
}

TEST(LensDistortion, derivative_of_the_pixel_equals_its_numeric_twin) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Camera& camera : {scene::rational_camera(), scene::fisheye_camera()}) {
    for (int i = 0; i < 300; ++i) {
      const double spread = camera.lens == Model::fisheye && i % 2 ? 4.0 : 0.4;
      const Eigen::Vector3d point(spread * unit(random), spread * unit(random), 0.9 + 0.1 * unit(random));
      Eigen::Matrix<double, 2, 3> derivative;
      ASSERT_TRUE(camera.project(point, derivative));
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
        const Eigen::Vector2d numeric = (*camera.project(point + h) - *camera.project(point - h)) / 2e-6;
        EXPECT_LT((numeric - derivative.col(k)).norm(), 1e-4);
      }
    }
    Eigen::Matrix<double, 2, 3> on_axis;
    EXPECT_TRUE(camera.project({0, 0, 2}, on_axis)->isApprox(Eigen::Vector2d(camera.cx, camera.cy), 1e-12));
    EXPECT_NEAR(on_axis(0, 0), camera.fx / 2, 1e-9);
    EXPECT_NEAR(on_axis(1, 1), camera.fy / 2, 1e-9);
  }
}

/// The radial part by its formula, walking outwards along the angle.
double fold_by_walking(const LensDistortion::Coefficients& d, Model model) {
  double last = 0.0;
  for (double angle = 1e-3; angle < M_PI_2; angle += 1e-3) {
    const double r = std::tan(angle), s = r * r, t = angle * angle;
    const double below = 1 + s * (d[5] + s * (d[6] + s * d[7]));
    const double here = model == Model::fisheye
                            ? angle * (1 + t * (d[0] + t * (d[1] + t * (d[2] + t * d[3]))))
                            : r * (1 + s * (d[0] + s * (d[1] + s * d[4]))) / below;
    if (!(here > last) || (model == Model::rational && below <= 0)) return angle;
    last = here;
  }
  return M_PI_2;
}

TEST(LensDistortion, its_fold_is_where_the_radial_part_turns_back) {
  std::mt19937 random(6);
  int folds = 0;
  for (int i = 0; i < 2000; ++i) {
    const Model model = i % 2 ? Model::fisheye : Model::rational;
    const LensDistortion::Coefficients d = drawn(model, random, i % 2 ? 0.2 : 1.0);
    const LensDistortion lens(d, model);
    const double walked = fold_by_walking(d, model), found = std::atan(std::sqrt(lens.fold_squared()));
    EXPECT_NEAR(found, walked, 2e-3) << i;
    if (walked > 1.56) continue;
    ++folds;
    Eigen::Matrix2d unused;
    EXPECT_FALSE(lens.distort({std::tan(walked + 3e-3), 0}, unused)) << i;
  }
  EXPECT_GT(folds, 500);
}

TEST(LensDistortion, a_fisheye_may_see_less_than_its_image_but_must_see_its_middle) {
  Camera camera = scene::fisheye_camera();
  EXPECT_NO_THROW(camera.validate());
  EXPECT_FALSE(camera.undistort({-0.5, -0.5})) << "100 degrees from the axis";
  camera.fx = camera.fy = 90;  // 90 degrees before half of the way to the left and right side
  EXPECT_THROW(camera.validate(), std::invalid_argument);
  camera = scene::fisheye_camera();
  camera.distortion[4] = 0.1;
  EXPECT_THROW(camera.validate(), std::invalid_argument);
  camera = scene::plain_camera();
  camera.distortion[7] = 0.1;
  EXPECT_THROW(camera.validate(), std::invalid_argument);
}

}  // namespace lens_distortion_test
}  // namespace clearway
