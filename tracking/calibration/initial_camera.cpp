#include "tracking/calibration/initial_camera.hpp"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

#include "tracking/dense.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

bool is_plausible(const Camera& camera) {
  try {
    camera.validate();
  } catch (const std::invalid_argument&) {
    return false;
  }
  return camera.fx > 0.2 * camera.width && camera.fx < 20.0 * camera.width;
}

}  // namespace

BoardPlane plane_of(const TagBody& board) {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& [id, tag] : board.tags)
    for (const Eigen::Vector3d& corner : tag_corners(tag.size))
      points.push_back(tag.body_from_tag * corner), middle += points.back();
  middle /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) spread += (point - middle) * (point - middle).transpose();
  const Eigen::Matrix3d axes = principal_axes(spread).axes;
  BoardPlane plane;
  Eigen::Vector3d normal = axes.col(0);
  if (normal.dot(board.tags.begin()->second.body_from_tag.linear().col(2)) < 0.0) normal = -normal;
  const Eigen::Vector3d along = axes.col(2);
  plane.board_from_plane.linear() << along, normal.cross(along), normal;
  plane.board_from_plane.translation() = middle;
  for (const Eigen::Vector3d& point : points)
    plane.thickness = std::max(plane.thickness, std::abs(normal.dot(point - middle)));
  return plane;
}

bool find_initial_camera(Bundle& bundle, const BoardPlane& plane, bool is_guess) {
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> images;
  const Eigen::Isometry3d plane_from_board = plane.board_from_plane.inverse();
  for (const BoardView& view : bundle.views) {
    objects.emplace_back();
    images.emplace_back();
    for (const TagDetection& tag : view.tags) {
      const MountedTag& mounted = bundle.board.tags.at(tag.id);
      const auto corners = tag_corners(mounted.size);
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d at = plane_from_board * (mounted.body_from_tag * corners[i]);
        objects.back().emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()), 0.0F);
        images.back().emplace_back(static_cast<float>(tag.corners[i].x()),
                                   static_cast<float>(tag.corners[i].y()));
      }
    }
  }
  cv::Mat matrix = cv::Mat::eye(3, 3, CV_64F), distortion;
  std::vector<cv::Mat> turns, places;
  Camera& camera = bundle.camera;
  int flags = cv::CALIB_FIX_K3;
  if (is_guess) {
    matrix.at<double>(0, 0) = matrix.at<double>(1, 1) = camera.width;
    matrix.at<double>(0, 2) = 0.5 * (camera.width - 1);
    matrix.at<double>(1, 2) = 0.5 * (camera.height - 1);
    distortion = cv::Mat::zeros(1, 5, CV_64F);
    flags |= cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_FOCAL_LENGTH | cv::CALIB_FIX_PRINCIPAL_POINT |
             cv::CALIB_FIX_TANGENT_DIST | cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2;
  }
  try {
    cv::calibrateCamera(objects, images, {camera.width, camera.height}, matrix, distortion, turns, places,
                        flags, cv::TermCriteria(cv::TermCriteria::COUNT, 8, 0.0));
  } catch (const cv::Exception&) {
    return false;
  }
  camera.fx = matrix.at<double>(0, 0);
  camera.fy = matrix.at<double>(1, 1);
  camera.cx = matrix.at<double>(0, 2);
  camera.cy = matrix.at<double>(1, 2);
  for (int i = 0; i < 4; ++i) camera.distortion[static_cast<std::size_t>(i)] = distortion.at<double>(i);
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const Eigen::Vector3d by(turns[v].at<double>(0), turns[v].at<double>(1), turns[v].at<double>(2));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (by.norm() > 0.0) pose.linear() = Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix();
    pose.translation() =
        Eigen::Vector3d(places[v].at<double>(0), places[v].at<double>(1), places[v].at<double>(2));
    bundle.views[v].camera_from_board = pose * plane_from_board;
  }
  return is_plausible(camera);
}

}  // namespace clearway
