#include "datasets/simulation/image_renderer.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/calib3d.hpp>

#include "datasets/simulation/tag_pattern.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/worlds/sample_frames.hpp"

namespace clearway {
namespace image_renderer_test {

const CameraIntrinsics camera{320, 240, 400, 402, 161.5, 118, {-0.12, 0.05, 0.0005, -0.0004, 0.01}};

Eigen::Isometry3d tag_pose(double x, double y, double z, double tilt, double turn) {
  // In front of a camera at the origin: x right, y down, z forward; the tag faces it.
  Eigen::Isometry3d pose(Eigen::Translation3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d(0.6, 0.8, 0)));
  pose.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  return pose;
}

Radiance draw(const std::vector<Surface>& still, const std::vector<Surface>& moving = {},
              const CameraIntrinsics& by = camera) {
  return ImageRenderer(std::make_shared<const PixelRays>(by), Eigen::Isometry3d::Identity(), still, 40)
      .draw(moving);
}

double level(const Radiance& picture, const Eigen::Vector2d& at) {
  const int i = static_cast<int>(std::floor(at.x())), j = static_cast<int>(std::floor(at.y()));
  const double u = at.x() - i, v = at.y() - j;
  const auto value = [&](int column, int row) {
    return picture.values.at(static_cast<size_t>(row * picture.width + column));
  };
  return (1 - v) * ((1 - u) * value(i, j) + u * value(i + 1, j)) +
         v * ((1 - u) * value(i, j + 1) + u * value(i + 1, j + 1));
}

/// Pixels by OpenCV of points in the tag's plane.
std::vector<Eigen::Vector2d> projected(const Eigen::Isometry3d& camera_from_tag,
                                       const std::vector<Eigen::Vector2d>& points,
                                       const CameraIntrinsics& by = camera) {
  std::vector<cv::Point3d> in_camera;
  for (const auto& p : points) {
    const Eigen::Vector3d q = camera_from_tag * Eigen::Vector3d(p.x(), p.y(), 0);
    in_camera.emplace_back(q.x(), q.y(), q.z());
  }
  std::vector<cv::Point2d> pixels;
  const cv::Matx33d matrix(by.fx, 0, by.cx, 0, by.fy, by.cy, 0, 0, 1);
  const std::vector<double> lens(coefficients_of(by).begin(), coefficients_of(by).end());
  if (by.lens == LensModel::fisheye)
    cv::fisheye::projectPoints(in_camera, pixels, cv::Vec3d(), cv::Vec3d(), matrix, lens);
  else
    cv::projectPoints(in_camera, cv::Vec3d(), cv::Vec3d(), matrix, lens, pixels);
  std::vector<Eigen::Vector2d> result;
  for (const auto& pixel : pixels) result.emplace_back(pixel.x, pixel.y);
  return result;
}

/// Where the picture goes from black to white on the way from `inside` to `outside`, found by the area under
/// the profile: an edge between black and white of any blur lies where the mean level says it does.
double edge_offset(const Radiance& picture, const Eigen::Vector2d& inside, const Eigen::Vector2d& edge,
                   const Eigen::Vector2d& outside) {
  const double black = level(picture, inside), white = level(picture, outside);
  const double length = (outside - inside).norm();
  double area = 0;
  constexpr int steps = 400;
  for (int i = 0; i < steps; ++i)
    area +=
        (white - level(picture, inside + (i + 0.5) / steps * (outside - inside))) / (white - black) / steps;
  return area * length - (edge - inside).norm();
}

TEST(ImageRenderer, BordersOfTagsLieWhereOpenCvProjectsThem) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double sum = 0, worst = 0, worst_side = 0, count = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const auto pose = tag_pose(0.06 * uniform(random), 0.04 * uniform(random), 0.45 + 0.1 * uniform(random),
                               0.6 * uniform(random), 3 * uniform(random));
    const double size = 0.12, h = size / 2, cell = size / 8;
    const Radiance picture = draw({Surface(TagShape{size, tag36h11_cells(trial)}, pose)});
    for (int side = 0; side < 4; ++side) {
      const Eigen::Rotation2Dd turn(side * M_PI / 2);
      const double sum_before = sum, count_before = count;
      for (double along = -0.8; along <= 0.8; along += 0.1) {
        const auto at = projected(
            pose, {turn * Eigen::Vector2d(along * h, h - 0.5 * cell), turn * Eigen::Vector2d(along * h, h),
                   turn * Eigen::Vector2d(along * h, h + 0.5 * cell)});
        const double offset = edge_offset(picture, at[0], at[1], at[2]);
        sum += offset;
        worst = std::max(worst, std::abs(offset));
        ++count;
      }
      worst_side = std::max(worst_side, std::abs(sum - sum_before) / (count - count_before));
    }
  }
  EXPECT_LT(worst_side, 0.05) << "each side, mean of its 17 profiles";
  EXPECT_LT(worst, 0.15) << "single profiles, read by bilinear interpolation";
  EXPECT_LT(std::abs(sum / count), 0.01) << "no bias towards black or white";
}

TEST(ImageRenderer, TagsBeforeWideLensesLieWhereOpenCvProjectsThemFarFromTheAxisToo) {
  CameraIntrinsics rational{
      320, 240, 200, 201, 161.5, 118, {0.42, -2.1, 0.0005, -0.0003, 1.3, 0.31, -1.9, 1.2}};
  rational.lens = LensModel::rational;
  CameraIntrinsics fisheye{320, 240, 115, 116, 161.5, 118, {-0.012, 0.021, -0.017, 0.003}};
  fisheye.lens = LensModel::fisheye;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const CameraIntrinsics& by : {rational, fisheye}) {
    double sum = 0, worst = 0, count = 0;
    for (int trial = 0; trial < 30; ++trial) {
      // Facing the camera, up to 30 and 70 degrees from its axis.
      const double aside = (by.lens == LensModel::fisheye ? 1.2 : 0.5) * uniform(random);
      Eigen::Isometry3d pose(Eigen::AngleAxisd(aside, Eigen::Vector3d::UnitY()));
      pose = pose * tag_pose(0, 0.05 * uniform(random), 0.3, 0.4 * uniform(random), 3 * uniform(random));
      const double size = 0.12, h = size / 2, cell = size / 8;
      const Radiance picture = draw({Surface(TagShape{size, tag36h11_cells(trial)}, pose)}, {}, by);
      for (int side = 0; side < 4; ++side) {
        const Eigen::Rotation2Dd turn(side * M_PI / 2);
        for (double along = -0.8; along <= 0.8; along += 0.1) {
          const auto at = projected(
              pose,
              {turn * Eigen::Vector2d(along * h, h - 0.5 * cell), turn * Eigen::Vector2d(along * h, h),
               turn * Eigen::Vector2d(along * h, h + 0.5 * cell)},
              by);
          const auto is_in = [](const Eigen::Vector2d& p) {
            return p.x() > 2 && p.x() < 317 && p.y() > 2 && p.y() < 237;
          };
          if (!std::all_of(at.begin(), at.end(), is_in)) continue;
          const double offset = edge_offset(picture, at[0], at[1], at[2]);
          sum += offset;
          worst = std::max(worst, std::abs(offset));
          ++count;
        }
      }
    }
    EXPECT_GT(count, 1200) << lens_name(by.lens);
    EXPECT_LT(worst, 0.25) << lens_name(by.lens) << ", single profiles of small tags";
    EXPECT_LT(std::abs(sum / count), 0.02) << lens_name(by.lens);
  }
}

TEST(ImageRenderer, BeyondItsFieldAFisheyeSeesBlackAndWithinItTheBackgroundOrWhatIsThere) {
  CameraIntrinsics fisheye{320, 240, 80, 80, 159.5, 119.5, {}};  // 90 degrees: 126 pixels from the middle
  fisheye.lens = LensModel::fisheye;
  // A wall all around ahead: only what is 90 degrees aside misses it.
  const SceneShape wall{"wall", BoxShape{{100, 100, 1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1.0)),
                        200};
  for (const bool is_wall : {false, true}) {
    const Radiance picture = is_wall ? draw({Surface(wall)}, {}, fisheye) : draw({}, {}, fisheye);
    for (int row = 0; row < 240; ++row)
      for (int column = 0; column < 320; ++column) {
        const double off = std::hypot(column - 159.5, row - 119.5),
                     value = picture.values[320 * row + column];
        if (off > 127) {
          EXPECT_EQ(value, 0) << column << " " << row;
        } else if (off < 120) {
          EXPECT_TRUE(is_wall ? value > 60 : value == 40) << column << " " << row;
        }
      }
  }
}

TEST(ImageRenderer, BallsAreAsLargeAsTheirOutlineSays) {
  const CameraIntrinsics pinhole{320, 240, 400, 400, 160, 120, {}};
  const Eigen::Vector3d center(0.02, -0.01, 0.6);
  const double radius = 0.05;
  const ImageRenderer renderer(std::make_shared<const PixelRays>(pinhole), Eigen::Isometry3d::Identity(), {},
                               0);
  const SceneShape ball{"ball", SphereShape{radius}, Eigen::Isometry3d(Eigen::Translation3d(center)), 200};
  const Radiance picture = renderer.draw(std::vector<Surface>{Surface(ball)});
  // Solid angle of the ball against that of the pixels it lights (dark ones are background).
  double seen = 0;
  for (int row = 0; row < 240; ++row)
    for (int column = 0; column < 320; ++column) {
      const Eigen::Vector3d ray = *Lens(pinhole).pixel_ray({column, row});
      const double level = picture.values[static_cast<size_t>(320 * row + column)];
      if (level > 0) seen += std::pow(ray.norm(), -3) / (400.0 * 400.0);
    }
  const double sine = radius / center.norm(), expected = 2 * M_PI * (1 - std::sqrt(1 - sine * sine));
  const double rim = 2 * M_PI * sine / 400;  // half a pixel of rim counts too much
  EXPECT_NEAR(seen, expected + rim / 2, rim / 2);
}

TEST(ImageRenderer, MovingSurfacesAreDrawnAsIfTheyStood) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int different = 0;
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Surface> still, moving;
    const auto place = [&] {
      return Eigen::Isometry3d(
          Eigen::Translation3d(0.2 * uniform(random), 0.15 * uniform(random), 0.8 + 0.3 * uniform(random)));
    };
    for (int i = 0; i < 4; ++i) {
      still.emplace_back(SceneShape{"b", BoxShape{{0.1, 0.07, 0.05}}, place(), 60.0 + 30 * i});
      moving.emplace_back(SceneShape{"c", CylinderShape{0.03, 0.2}, place(), 200.0 - 30 * i});
    }
    moving.emplace_back(TagShape{0.06, tag36h11_cells(5)}, tag_pose(0, 0, 0.5, 0.3, trial));
    std::vector<Surface> all = still;
    all.insert(all.end(), moving.begin(), moving.end());
    const auto moved = draw(still, moving).values, stood = draw(all).values;
    for (size_t i = 0; i < stood.size(); ++i) {
      different += moved[i] != stood[i];
      EXPECT_NEAR(moved[i], stood[i], 5);
    }
  }
  EXPECT_LE(different, 5) << "of 768,000: a corner that no pixel's centre sees";
}

TEST(ImageRenderer, NothingInSightIsBackground) {
  const auto picture = draw({}, {});
  EXPECT_EQ(picture.values, std::vector<float>(320 * 240, 40));
}

TEST(Exposure, BlurKeepsTheMeanAndNoiseHasItsSigma) {
  Radiance grey{64, 48, std::vector<float>(64 * 48, 100)};
  grey.values[64 * 20 + 30] = 200;
  const auto still = expose(grey, 1.0, 0, 1, 1);
  const double sum = std::accumulate(still.pixels.begin(), still.pixels.end(), 0.0) - 100.0 * 64 * 48;
  EXPECT_NEAR(sum, 100, 10);
  EXPECT_EQ(still.pixels[64 * 20 + 29], still.pixels[64 * 20 + 31]);
  EXPECT_EQ(still.pixels[64 * 19 + 30], still.pixels[64 * 20 + 31]);

  const Radiance flat{200, 200, std::vector<float>(200 * 200, 100)};
  const auto noisy = expose(flat, 0.6, 3, 1, 1);
  double squares = 0;
  for (uint8_t pixel : noisy.pixels) squares += (pixel - 100.0) * (pixel - 100.0);
  EXPECT_NEAR(std::sqrt(squares / (200 * 200) - 1.0 / 12), 3, 0.05);
  EXPECT_NE(expose(flat, 0.6, 3, 1, 2), noisy);
  EXPECT_NE(expose(flat, 0.6, 3, 2, 1), noisy);
  EXPECT_EQ(expose(flat, 0.6, 3, 1, 1), noisy);
}

}  // namespace image_renderer_test
}  // namespace clearway
