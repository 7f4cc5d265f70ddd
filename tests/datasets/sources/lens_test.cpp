#include "datasets/sources/lens.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

namespace clearway {
namespace lens_test {

const CameraIntrinsics camera{640, 480, 700, 702, 322.5, 238, {-0.12, 0.05, 0.0005, -0.0004, 0.01}};

CameraIntrinsics with_lens(LensModel model, const std::vector<double>& coefficients) {
  CameraIntrinsics result = camera;
  set_lens(result, model, coefficients);
  return result;
}

/// Of each model two, the second as real calibrations are: an Azure Kinect's and a T265's.
std::vector<CameraIntrinsics> cameras() {
  return {camera, with_lens(LensModel::rational, {-0.1, 0.06, 0.0006, -0.0004, 0.01, 0.05, -0.02, 0.03}),
          with_lens(LensModel::rational, {0.42, -2.1, 0.0005, -0.0003, 1.3, 0.31, -1.9, 1.2}),
          with_lens(LensModel::fisheye, {0, 0, 0, 0}),
          with_lens(LensModel::fisheye, {-0.0069, 0.0459, -0.0429, 0.0078})};
}

cv::Mat coefficients_for_opencv(const CameraIntrinsics& c) {
  return cv::Mat(std::vector<double>(coefficients_of(c).begin(), coefficients_of(c).end()), true);
}

cv::Point2d project_by_opencv(const CameraIntrinsics& c, const Eigen::Vector3d& point) {
  const std::vector<cv::Point3d> points{{point.x(), point.y(), point.z()}};
  const cv::Matx33d matrix(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  std::vector<cv::Point2d> pixels;
  if (c.lens == LensModel::fisheye)
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrix, coefficients_for_opencv(c));
  else
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, coefficients_for_opencv(c), pixels);
  return pixels[0];
}

TEST(Lens, ProjectsAsOpenCvDoes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (const CameraIntrinsics& c : cameras()) {
    const double spread = c.lens == LensModel::fisheye ? 20 : 1;  // a fisheye to 88 degrees and more
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d point(spread * uniform(random), spread * uniform(random), 1 + uniform(random));
      const auto ours = Lens(c).project(point);
      ASSERT_TRUE(ours) << lens_name(c.lens);
      const cv::Point2d theirs = project_by_opencv(c, point);
      EXPECT_NEAR(ours->x(), theirs.x, 1e-9);
      EXPECT_NEAR(ours->y(), theirs.y, 1e-9);
    }
  }
}

TEST(Lens, TheRayOfEveryPixelProjectsBackToIt) {
  for (const CameraIntrinsics& c : cameras()) {
    const Lens lens(c);
    for (int row = -1; row <= 480; row += 13) {
      for (int column = -1; column <= 640; column += 11) {
        const Eigen::Vector2d pixel(column, row);
        const auto ray = lens.pixel_ray(pixel);
        ASSERT_TRUE(ray) << lens_name(c.lens);
        EXPECT_LT((*lens.project(*ray) - pixel).norm(), 1e-9);
      }
    }
  }
}

/// The angle to the axis at which OpenCV's own pixel stops moving outwards, walking in small steps.
double widest_by_walking(const CameraIntrinsics& c) {
  double last = 0;
  for (double angle = 1e-3; angle < M_PI_2 - 1e-3; angle += 1e-3) {
    const double here = project_by_opencv(c, {std::tan(angle), 0, 1}).x - c.cx;
    if (!(here > last)) return angle;
    last = here;
  }
  return M_PI_2;
}

TEST(Lens, ItsFieldEndsWhereTheModelTurnsBackAndItsPixelsHaveNoRaysThere) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int ended = 0;
  for (int i = 0; i < 400; ++i) {
    const bool is_fisheye = i % 2 == 0;
    const CameraIntrinsics c =
        is_fisheye ? with_lens(LensModel::fisheye, {0.2 * unit(random), 0.2 * unit(random),
                                                    0.1 * unit(random), 0.05 * unit(random)})
                   : with_lens(LensModel::rational, {unit(random), unit(random), 0, 0, unit(random),
                                                     unit(random), unit(random), unit(random)});
    const Lens lens(c);
    const double walked = widest_by_walking(c);
    EXPECT_NEAR(lens.widest(), walked, 3e-3) << i;
    if (walked > 1.56) continue;
    EXPECT_TRUE(lens.project({std::tan(walked - 4e-3), 0, 1}));
    EXPECT_FALSE(lens.project({std::tan(walked + 4e-3), 0, 1}));
    const double rim = lens.project({std::tan(lens.widest() - 1e-9), 0, 1})->x();
    if (rim > 1e6) continue;  // a pole of the rational model, which moves all that far out
    ++ended;
    EXPECT_FALSE(lens.pixel_ray({rim + 0.01, c.cy})) << i;
    const auto within = lens.pixel_ray({c.cx + 0.99 * (rim - c.cx), c.cy});
    ASSERT_TRUE(within) << i;
    EXPECT_LT(std::atan(within->x()), lens.widest());
  }
  EXPECT_GT(ended, 100);
}

TEST(Lens, AFisheyeHasNoRaysOf90DegreesAndMore) {
  const CameraIntrinsics c = with_lens(LensModel::fisheye, {0, 0, 0, 0});  // 700 pixels per radian
  EXPECT_TRUE(Lens(c).pixel_ray({c.cx + 700 * 1.57, c.cy}));
  EXPECT_FALSE(Lens(c).pixel_ray({c.cx + 700 * 1.5708, c.cy}));
}

TEST(Lens, AFoldedPlumbBobStillGivesANumber) {
  CameraIntrinsics folded = camera;
  folded.distortion = {-3, 0, 0, 0, 0};
  EXPECT_TRUE(Lens(folded).pixel_ray({0, 0})->allFinite());
}

TEST(Lens, ARationalOneWithoutADenominatorIsAPlumbBob) {
  const CameraIntrinsics c = with_lens(LensModel::rational, {-0.12, 0.05, 0.0005, -0.0004, 0.01, 0, 0, 0});
  EXPECT_EQ(c, camera);
}

TEST(Lens, NumbersThatTheModelDoesNotHaveMustBe0) {
  EXPECT_EQ(with_lens(LensModel::fisheye, {0.1, 0, 0, 0, 0}), with_lens(LensModel::fisheye, {0.1, 0, 0, 0}));
  EXPECT_THROW(with_lens(LensModel::fisheye, {0.1, 0, 0, 0, 1e-3}), std::runtime_error);
  EXPECT_THROW(with_lens(LensModel::plumb_bob, {0.1, 0, 0, 0, 0, 1e-3}), std::runtime_error);
  EXPECT_THROW(with_lens(LensModel::rational, {0.1, 0, 0, 0, 0, 1, 0, 0, 1e-3}), std::runtime_error);
}

TEST(Lens, ItsNamesAreOursAndThoseOfRosAndKalibr) {
  for (const LensModel model : {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye})
    EXPECT_EQ(lens_named(lens_name(model)), model);
  EXPECT_EQ(lens_named("radtan"), LensModel::plumb_bob);
  EXPECT_EQ(lens_named("rational_polynomial"), LensModel::rational);
  EXPECT_EQ(lens_named("equidistant"), LensModel::fisheye);
  EXPECT_FALSE(lens_named("omni"));
}

TEST(Lens, DepthRaysAreThoseThatOpenCvFinds) {
  for (CameraIntrinsics c : cameras()) {
    c.width = 64;
    c.height = 48;
    c.fx = 60;
    c.fy = 61;
    c.cx = 31.5;
    c.cy = 23.5;
    const std::vector<Eigen::Vector2d> rays = depth_rays(c);
    std::vector<cv::Point2d> pixels, expected;
    for (int row = 0; row < 48; ++row)
      for (int column = 0; column < 64; ++column) pixels.emplace_back(column, row);
    const cv::Matx33d matrix(60, 0, 31.5, 0, 61, 23.5, 0, 0, 1);
    if (c.lens == LensModel::fisheye)
      cv::fisheye::undistortPoints(pixels, expected, matrix, coefficients_for_opencv(c));
    else
      cv::undistortPoints(pixels, expected, matrix, coefficients_for_opencv(c), cv::noArray(), cv::noArray(),
                          {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-12});
    ASSERT_EQ(rays.size(), expected.size());
    double bent = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_LT(std::hypot(rays[i].x() - expected[i].x, rays[i].y() - expected[i].y), 1e-7) << i;
      bent = std::max(bent, std::abs(rays[i].x() - (pixels[i].x - 31.5) / 60));
    }
    EXPECT_GT(bent, 1e-3) << "a pinhole would do";
  }
}

TEST(Lens, APixelWhereALensFoldsOverHasNoDepthRay) {
  const auto rays = depth_rays({64, 48, 20, 21, 31.5, 23.5, {-0.4, 0, 0, 0, 0}});
  EXPECT_FALSE(rays.front().allFinite()) << "r (1 - 0.4 r^2) is nowhere 1.9";
  EXPECT_TRUE(rays[24 * 64 + 32].allFinite());
}

}  // namespace lens_test
}  // namespace clearway
