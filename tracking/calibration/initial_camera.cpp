#include "tracking/calibration/initial_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <stdexcept>

#include "tracking/calibration/upper_median.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_refinement.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

Eigen::Isometry3d isometry_of(const cv::Mat& turn, const cv::Mat& place) {
  const Eigen::Vector3d by(turn.at<double>(0), turn.at<double>(1), turn.at<double>(2));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (by.norm() > 0.0) pose.linear() = Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(place.at<double>(0), place.at<double>(1), place.at<double>(2));
  return pose;
}

bool is_plausible(const Camera& camera) {
  try {
    camera.validate();
  } catch (const std::invalid_argument&) {
    return false;
  }
  return camera.fx > 0.2 * camera.width && camera.fx < 20.0 * camera.width;
}

/// The part of a view that a camera sees, with the better of its two poses (IPPE, Collins and Bartoli 2014),
/// refined, and the mean squared error of its corners; none where that is less than two tags.
struct PlacedView {
  BoardView view;
  double squared_error = 0.0;
};

std::optional<PlacedView> place(const Camera& camera, const TagBody& board, const BoardPlane& plane,
                                const BoardView& view) {
  const Eigen::Isometry3d plane_from_board = plane.board_from_plane.inverse();
  PlacedView placed{{view.name, {}}};
  std::vector<CornerMatch> corners;
  std::vector<cv::Point3d> objects;
  std::vector<cv::Point2d> rays;
  for (const TagDetection& tag : view.tags) {
    const MountedTag& mounted = board.tags.at(tag.id);
    const auto points = tag_corners(mounted.size);
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& pixel : tag.corners)
      if (const auto ray = camera.undistort(pixel); ray && ray->norm() < 8.0) seen.push_back(*ray);
    if (seen.size() < 4) continue;
    placed.view.tags.push_back(tag);
    for (std::size_t i = 0; i < 4; ++i) {
      corners.push_back({mounted.body_from_tag * points[i], tag.corners[i]});
      const Eigen::Vector3d at = plane_from_board * corners.back().in_body;
      objects.emplace_back(at.x(), at.y(), 0.0);
      rays.emplace_back(seen[i].x(), seen[i].y());
    }
  }
  if (placed.view.tags.size() < 2) return std::nullopt;
  std::vector<cv::Mat> turns, places;
  try {
    cv::solvePnPGeneric(objects, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, places, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  bool is_placed = false;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const auto pose = refine_pose(camera, corners, isometry_of(turns[i], places[i]) * plane_from_board);
    if (!pose) continue;
    const double squared = pose->squared_error / static_cast<double>(corners.size());
    if (is_placed && !(squared < placed.squared_error)) continue;
    is_placed = true;
    placed.squared_error = squared;
    placed.view.camera_from_board = pose->camera_from_body;
  }
  return is_placed ? std::optional(placed) : std::nullopt;
}

/// atan(r) = r N / D to 0.1 % at 60 degrees, N and D of degree 3 in r^2 (Pade's approximant).
constexpr LensDistortion::Coefficients kPadeOfArctangent{
    19250.0 / 15015, 5943.0 / 15015, 0, 0, 256.0 / 15015, 24255.0 / 15015, 11025.0 / 15015, 1225.0 / 15015};

/// All views of a bundle as a camera sees them, and the middle of their squared errors: images that
/// contradict do not count; infinity where it sees less than half of them.
struct PlacedViews {
  std::vector<BoardView> views;
  double error = std::numeric_limits<double>::infinity();
};

PlacedViews place_all(const Camera& camera, const Bundle& bundle, const BoardPlane& plane) {
  PlacedViews all;
  std::vector<double> errors(bundle.views.size(), all.error);
  for (std::size_t v = 0; v < bundle.views.size(); ++v)
    if (const auto placed = place(camera, bundle.board, plane, bundle.views[v])) {
      all.views.push_back(placed->view);
      errors[v] = placed->squared_error;
    }
  all.error = upper_median(std::move(errors));
  return all;
}

/// @param model what bends as an equidistant fisheye does: that one, or a rational lens
bool find_equidistant(Bundle& bundle, const BoardPlane& plane, LensDistortion::Model model) {
  constexpr int steps = 32;
  constexpr double narrowest = 0.6, widest = 2.2;  // radians in the corner
  Camera camera = bundle.camera;
  camera.lens = model;
  camera.distortion = {};
  if (model == LensDistortion::Model::rational) camera.distortion = kPadeOfArctangent;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  const Bundle given = bundle;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const double corner = narrowest * std::pow(widest / narrowest, static_cast<double>(i) / steps);
    camera.fx = camera.fy = std::hypot(camera.cx, camera.cy) / corner;
    const PlacedViews placed = place_all(camera, given, plane);
    if (!(placed.error < least)) continue;
    least = placed.error;
    bundle.camera = camera;
    bundle.views = placed.views;
  }
  return std::isfinite(least);
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
  const Eigen::Vector3d side = board.tags.begin()->second.body_from_tag.linear().col(0);
  const Eigen::Vector3d along = (side - normal.dot(side) * normal).normalized();
  plane.board_from_plane.linear() << along, normal.cross(along), normal;
  plane.board_from_plane.translation() = middle;
  for (const Eigen::Vector3d& point : points) {
    plane.thickness = std::max(plane.thickness, std::abs(normal.dot(point - middle)));
    plane.reach = std::max(plane.reach, (point - middle).norm());
  }
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
  int flags = cv::CALIB_FIX_K3 | cv::CALIB_USE_QR;  // by singular values it takes several times as long
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
    bundle.views[v].camera_from_board = isometry_of(turns[v], places[v]) * plane_from_board;
  }
  return is_plausible(camera);
}

bool find_initial_fisheye(Bundle& bundle, const BoardPlane& plane) {
  return find_equidistant(bundle, plane, LensDistortion::Model::fisheye);
}

bool find_initial_rational(Bundle& bundle, const BoardPlane& plane) {
  const Bundle given = bundle;
  const bool is_wide = find_equidistant(bundle, plane, LensDistortion::Model::rational);
  Bundle narrow = given;
  narrow.camera.lens = LensDistortion::Model::plumb_bob;
  if (!find_initial_camera(narrow, plane, false) && !find_initial_camera(narrow, plane, true)) return is_wide;
  narrow.camera.lens = LensDistortion::Model::rational;
  const PlacedViews placed = place_all(narrow.camera, given, plane);
  if (is_wide && (tags_of(placed.views) < tags_of(bundle.views) ||
                  !(placed.error < place_all(bundle.camera, given, plane).error)))
    return true;
  bundle.camera = narrow.camera;
  bundle.views = placed.views;
  return std::isfinite(placed.error);
}

}  // namespace clearway
