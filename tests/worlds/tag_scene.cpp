#include "tests/worlds/tag_scene.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "planning/geometry/turn_between.hpp"

namespace clearway::scene {
namespace {

/// OpenCV's coefficients of any lens.
cv::Mat coefficients_of(const Camera& c) {
  const int count = c.lens == LensDistortion::Model::fisheye ? 4 : 8;
  return cv::Mat(1, count, CV_64F, const_cast<double*>(c.distortion.data()));
}

cv::Matx33d matrix_of(const Camera& c) { return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}; }

/// 10 x 10 cells of a printed tag, upper row first: white ring, black ring, 6 x 6 bits.
std::array<std::array<int, 10>, 10> cells_of(int id) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* image = apriltag_to_image(family, static_cast<std::uint32_t>(id));
  std::array<std::array<int, 10>, 10> cells{};
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) cells[y][x] = image->buf[y * image->stride + x];
  std::free(image->buf);  // Debian's library does not export image_u8_destroy
  std::free(image);
  tag36h11_destroy(family);
  return cells;
}

/// The cell of the print at a place of its plane (metres, x right, y up): column and row.
struct Cell {
  int column, row;
  bool operator==(const Cell&) const = default;
};
Cell cell_at(double size, const Eigen::Vector3d& at) {
  const auto clamped = [](double x) { return static_cast<int>(std::floor(std::clamp(x, -2.0, 12.0))); };
  return {clamped(at.x() / size * 8.0 + 5.0), clamped(5.0 - at.y() / size * 8.0)};
}

/// Its grey; -1 beyond the paper (12 cells wide).
int grey_of(const std::array<std::array<int, 10>, 10>& cells, const Cell& cell) {
  const auto [c, r] = cell;
  if (c < -1 || c >= 11 || r < -1 || r >= 11) return -1;
  const bool is_on_print = c >= 0 && c < 10 && r >= 0 && r < 10;
  return !is_on_print || cells[r][c] ? 225 : 30;
}

void draw(const Camera& camera, const PlacedTag& tag, int n, cv::Mat& grey) {
  const auto cells = cells_of(tag.id);
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Eigen::Vector2d& c : true_corners(camera, {tag.id, tag.size * 1.6, tag.camera_from_tag}))
    low = low.cwiseMin(c), high = high.cwiseMax(c);
  const int x0 = std::max(0, int(low.x()) - 3), x1 = std::min(camera.width - 1, int(high.x()) + 3);
  const int y0 = std::max(0, int(low.y()) - 3), y1 = std::min(camera.height - 1, int(high.y()) + 3);
  if (x0 > x1 || y0 > y1) return;
  std::vector<cv::Point2d> pixels, rays;  // of the pixel corners; in between, a bilinear ray is exact enough
  for (int y = y0; y <= y1 + 1; ++y)
    for (int x = x0; x <= x1 + 1; ++x) pixels.emplace_back(x - 0.5, y - 0.5);
  if (camera.lens == LensDistortion::Model::fisheye)
    cv::fisheye::undistortPoints(pixels, rays, matrix_of(camera), coefficients_of(camera));
  else
    cv::undistortPoints(pixels, rays, matrix_of(camera), coefficients_of(camera), cv::noArray(),
                        cv::noArray(), cv::TermCriteria(cv::TermCriteria::COUNT, 14, 0));
  const int stride = x1 - x0 + 2;
  const Eigen::Matrix3d r = tag.camera_from_tag.linear();
  const Eigen::Vector3d t = tag.camera_from_tag.translation();
  const Eigen::RowVector3d inverse_depth = r.col(2).transpose() / r.col(2).dot(t);
  const auto cell_of = [&](const cv::Point2d& at) {
    const Eigen::Vector3d ray(at.x, at.y, 1.0);
    return cell_at(tag.size, r.transpose() * (ray / inverse_depth.dot(ray) - t));
  };
  std::vector<Cell> met;  // by the rays, while the plane is before the camera
  for (const cv::Point2d& ray : rays) {
    const bool is_before = inverse_depth.dot(Eigen::RowVector3d(ray.x, ray.y, 1.0)) > 1e-3;
    met.push_back(is_before ? cell_of(ray) : Cell{-9, static_cast<int>(met.size())});
  }
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const std::size_t first = static_cast<std::size_t>((y - y0) * stride + x - x0);
      const cv::Point2d* corner = &rays[first];
      const Cell* cell = &met[first];
      if (cell[0] == cell[1] && cell[0] == cell[stride] && cell[0] == cell[stride + 1]) {  // so all between
        if (const int value = grey_of(cells, cell[0]); value >= 0)
          grey.at<float>(y, x) = static_cast<float>(value);
        continue;
      }
      double sum = 0.0;
      for (int k = 0; k < n * n; ++k) {
        const double u = (k % n + 0.5) / n, v = (k / n + 0.5) / n;
        const cv::Point2d at = (1 - v) * ((1 - u) * corner[0] + u * corner[1]) +
                               v * ((1 - u) * corner[stride] + u * corner[stride + 1]);
        const int value = grey_of(cells, cell_of(at));
        sum += value >= 0 ? value : grey.at<float>(y, x);
      }
      grey.at<float>(y, x) = static_cast<float>(sum / (n * n));
    }
}

}  // namespace

Camera plain_camera() { return {640, 480, 600.0, 605.0, 318.0, 243.0, {}}; }

Camera distorted_camera() {
  return {640, 480, 600.0, 605.0, 318.0, 243.0, {-0.18, 0.06, 0.0006, -0.0004, 0.0}};
}

Camera rational_camera() {
  return {640,
          480,
          600.0,
          605.0,
          318.0,
          243.0,
          {0.42, -2.1, 0.0005, -0.0003, 1.3, 0.31, -1.9, 1.2},
          {},
          LensDistortion::Model::rational};
}

Camera fisheye_camera() {
  return {640,
          480,
          230.0,
          231.5,
          318.0,
          243.0,
          {-0.012, 0.021, -0.017, 0.003},
          {},
          LensDistortion::Model::fisheye};
}

Eigen::Isometry3d tag_before_camera(double distance, double tilt, double azimuth, double roll, double x,
                                    double y) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, distance);
  const Eigen::Vector3d axis(std::cos(azimuth), std::sin(azimuth), 0.0);
  pose.linear() = (Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(tilt, axis) *
                   Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  return pose;
}

Eigen::Vector2d pixel_by_opencv(const Camera& camera, const Eigen::Vector3d& point) {
  std::vector<cv::Point2d> pixel;
  const std::vector<cv::Point3d> points{{point.x(), point.y(), point.z()}};
  if (camera.lens == LensDistortion::Model::fisheye)
    cv::fisheye::projectPoints(points, pixel, cv::Vec3d(), cv::Vec3d(), matrix_of(camera),
                               coefficients_of(camera));
  else
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), coefficients_of(camera), pixel);
  return {pixel[0].x, pixel[0].y};
}

std::array<Eigen::Vector2d, 4> true_corners(const Camera& camera, const PlacedTag& tag) {
  const double h = tag.size / 2;
  const Eigen::Vector3d points[4] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
  std::array<Eigen::Vector2d, 4> corners;
  for (int i = 0; i < 4; ++i) corners[i] = pixel_by_opencv(camera, tag.camera_from_tag * points[i]);
  return corners;
}

cv::Mat render(const Camera& camera, const std::vector<PlacedTag>& tags, const Look& look) {
  cv::Mat grey(camera.height, camera.width, CV_32F, cv::Scalar(70));
  for (const PlacedTag& tag : tags) draw(camera, tag, look.supersample, grey);
  if (look.blur > 0) cv::GaussianBlur(grey, grey, cv::Size(), look.blur);
  std::mt19937 random(look.seed);
  std::normal_distribution<float> noise(0.0f, static_cast<float>(look.noise));
  if (look.noise > 0)
    std::for_each(grey.begin<float>(), grey.end<float>(), [&](float& g) { g += noise(random); });
  cv::Mat image;
  grey.convertTo(image, CV_8U);
  return image;
}

TagBody board(const std::string& name, int first, int columns, int rows, double size, double pitch) {
  TagBody body{name, {}};
  for (int i = 0; i < columns * rows; ++i) {
    MountedTag tag{size, Eigen::Isometry3d::Identity()};
    tag.body_from_tag.translation() = Eigen::Vector3d((i % columns - 0.5 * (columns - 1)) * pitch,
                                                      (0.5 * (rows - 1) - i / columns) * pitch, 0);
    body.tags[first + i] = tag;
  }
  return body;
}

TagBody cube(const std::string& name, int first, double size, double side) {
  TagBody body{name, {}};
  const Eigen::Vector3d axes[5] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (int i = 0; i < 5; ++i) {
    Eigen::Isometry3d face = Eigen::Isometry3d::Identity();
    face.linear() = turn_between(Eigen::Vector3d::UnitZ(), axes[i]).toRotationMatrix();
    face.translation() = 0.5 * side * axes[i];
    body.tags[first + i] = {size, face};
  }
  return body;
}

std::vector<PlacedTag> placed(const TagBody& body, const Eigen::Isometry3d& camera_from_body) {
  std::vector<PlacedTag> tags;
  for (const auto& [id, tag] : body.tags) {
    const Eigen::Isometry3d camera_from_tag = camera_from_body * tag.body_from_tag;
    const double facing = -camera_from_tag.linear().col(2).dot(camera_from_tag.translation().normalized());
    if (facing > 0.25) tags.push_back({id, tag.size, camera_from_tag});
  }
  return tags;
}

std::vector<TagDetection> noisy_detections(const Camera& camera, const std::vector<PlacedTag>& tags,
                                           double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<TagDetection> detections;
  for (const PlacedTag& tag : tags) {
    TagDetection detection{tag.id, 0, 100.0, true_corners(camera, tag)};
    for (Eigen::Vector2d& corner : detection.corners)
      corner += sigma * Eigen::Vector2d(noise(random), noise(random));
    detections.push_back(detection);
  }
  return detections;
}

double angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

}  // namespace clearway::scene
