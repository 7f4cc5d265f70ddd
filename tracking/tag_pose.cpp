#include "tracking/tag_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <stdexcept>

namespace clearway {
namespace {

constexpr double kSmallestSide = 1e-6;  // normalised units
constexpr double kSmallestTurn = 0.05;  // sine of the turn at a corner; apriltag wants 10 degrees

// Clockwise on the image (y down), every corner a clear turn.
bool is_convex_clockwise(const std::array<Eigen::Vector2d, 4>& ray) {
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d in = ray[(i + 1) % 4] - ray[i], out = ray[(i + 2) % 4] - ray[(i + 1) % 4];
    if (!(in.norm() > kSmallestSide)) return false;
    if (!(in.x() * out.y() - in.y() * out.x() > kSmallestTurn * in.norm() * out.norm())) return false;
  }
  return true;
}

Eigen::Isometry3d to_isometry(const cv::Mat& rvec, const cv::Mat& tvec) {
  const Eigen::Vector3d turn(rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0.0) pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2));
  return pose;
}

std::optional<double> reprojection_rms(const std::array<Eigen::Vector2d, 4>& corners, double size,
                                       const Camera& camera, const Eigen::Isometry3d& camera_from_tag) {
  const std::array<Eigen::Vector3d, 4> points = tag_corners(size);
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const auto pixel = camera.project(camera_from_tag * points[i]);
    if (!pixel) return std::nullopt;
    sum += (*pixel - corners[i]).squaredNorm();
  }
  return std::sqrt(sum / 4.0);
}

}  // namespace

double TagPose::ambiguity_ratio() const {
  if (solutions.size() < 2 || !(solutions[0].rms_px > 0.0)) return std::numeric_limits<double>::infinity();
  return solutions[1].rms_px / solutions[0].rms_px;
}

std::array<Eigen::Vector3d, 4> tag_corners(double size) {
  const double h = 0.5 * size;
  return {Eigen::Vector3d(-h, h, 0.0), Eigen::Vector3d(h, h, 0.0), Eigen::Vector3d(h, -h, 0.0),
          Eigen::Vector3d(-h, -h, 0.0)};
}

bool faces_camera(const Eigen::Isometry3d& camera_from_tag) {
  return camera_from_tag.linear().col(2).dot(camera_from_tag.translation()) < 0.0;
}

TagPose estimate_tag_pose(const std::array<Eigen::Vector2d, 4>& corners, double size, const Camera& camera) {
  if (!(std::isfinite(size) && size > 0.0)) throw std::invalid_argument("tag pose: size must be > 0 metres");
  std::array<Eigen::Vector2d, 4> rays;
  for (int i = 0; i < 4; ++i) {
    const auto ray = camera.undistort(corners[i]);
    if (!ray) return {};
    rays[i] = *ray;
  }
  if (!is_convex_clockwise(rays)) return {};

  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (const Eigen::Vector3d& point : tag_corners(size)) object.emplace_back(point.x(), point.y(), point.z());
  for (const Eigen::Vector2d& ray : rays) image.emplace_back(ray.x(), ray.y());
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts, false,
                        cv::SOLVEPNP_IPPE_SQUARE);
  } catch (const cv::Exception&) {  // OpenCV's way to say that the corners are degenerate
    return {};
  }

  TagPose pose;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Eigen::Isometry3d camera_from_tag = to_isometry(turns[i], shifts[i]);
    if (!camera_from_tag.matrix().allFinite() || !faces_camera(camera_from_tag)) continue;
    if (const auto rms = reprojection_rms(corners, size, camera, camera_from_tag))
      pose.solutions.push_back({camera_from_tag, *rms});
  }
  std::stable_sort(pose.solutions.begin(), pose.solutions.end(),
                   [](const auto& a, const auto& b) { return a.rms_px < b.rms_px; });
  return pose;
}

}  // namespace clearway
