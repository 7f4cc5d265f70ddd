#include "tracking/calibration/view_spread.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace clearway {

double coverage_of(const Camera& camera, const std::vector<BoardView>& views) {
  cv::Mat seen = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  for (const BoardView& view : views) {
    std::vector<cv::Point> corners, hull;
    for (const TagDetection& tag : view.tags)
      for (const Eigen::Vector2d& corner : tag.corners)
        corners.emplace_back(static_cast<int>(std::lround(std::clamp(corner.x(), 0.0, camera.width - 1.0))),
                             static_cast<int>(std::lround(std::clamp(corner.y(), 0.0, camera.height - 1.0))));
    if (corners.empty()) continue;
    cv::convexHull(corners, hull);
    cv::fillConvexPoly(seen, hull, 255);
  }
  return cv::countNonZero(seen) / (static_cast<double>(camera.width) * camera.height);
}

double widest_tilt(const std::vector<BoardView>& views, const BoardPlane& plane) {
  std::vector<double> tilts;
  for (const BoardView& view : views) {
    const Eigen::Vector3d normal = view.camera_from_board.linear() * plane.board_from_plane.linear().col(2);
    tilts.push_back(std::acos(std::clamp(std::abs(normal.z()), 0.0, 1.0)));
  }
  std::sort(tilts.begin(), tilts.end());
  return tilts[tilts.size() * 9 / 10];
}

double widest_roll(const std::vector<BoardView>& views, const BoardPlane& plane) {
  std::vector<double> rolls;
  for (const BoardView& view : views) {
    const Eigen::Vector3d side = view.camera_from_board.linear() * plane.board_from_plane.linear().col(0);
    rolls.push_back(std::atan2(side.y(), side.x()));
  }
  double widest = 0.0;
  for (const double a : rolls)
    for (const double b : rolls) widest = std::max(widest, std::abs(std::remainder(a - b, M_PI)));
  return widest;
}

}  // namespace clearway
