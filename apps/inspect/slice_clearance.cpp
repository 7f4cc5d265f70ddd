#include "apps/inspect/slice_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace clearway {
namespace {

/// The lines are this many voxels apart, and end after so many.
constexpr double voxels_a_line = 2.0;
constexpr int lines = 16;

/// Number of the band between two lines that each pixel lies in; -1 for blocked.
cv::Mat bands(const SliceCanvas& canvas, const BlockedSpace& space, const SlicePlane& plane, double step) {
  cv::Mat result(canvas.height(), canvas.width(), CV_16S);
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.cols; ++column) {
      Eigen::Vector3d point;
      point[plane.axis] = plane.value;
      point[canvas.right] = canvas.right_at(SliceCanvas::margin_left + column);
      point[canvas.up] = canvas.up_at(SliceCanvas::margin_top + row);
      const double clearance = space.clearance(point);
      const bool blocked = clearance <= 0.0 && space.is_blocked(point);
      result.at<std::int16_t>(row, column) =
          static_cast<std::int16_t>(blocked ? -1 : static_cast<int>(std::floor(clearance / step)));
    }
  }
  return result;
}

}  // namespace

double draw_clearance(cv::Mat& image, const SliceCanvas& canvas, const Snapshot& map, const SlicePlane& plane,
                      Policy policy) {
  const double step = voxels_a_line * map.resolution();
  const double reach = step * (lines + 1);
  Eigen::AlignedBox3d region = map.bounds();
  region.min()[plane.axis] = std::max(region.min()[plane.axis], plane.value - reach);
  region.max()[plane.axis] = std::min(region.max()[plane.axis], plane.value + reach);
  const auto space = map.blocked_space({policy, 0xffff}, region, reach);
  const cv::Mat band = bands(canvas, *space, plane, step);
  const cv::Vec3b ink(196, 120, 32);
  for (int row = 0; row + 1 < band.rows; ++row) {
    for (int column = 0; column + 1 < band.cols; ++column) {
      const int here = band.at<std::int16_t>(row, column);
      for (const cv::Point& next : {cv::Point(column + 1, row), cv::Point(column, row + 1)}) {
        const int there = band.at<std::int16_t>(next);
        const int line = std::max(here, there);
        if (here == there || std::min(here, there) < 0 || line > lines) continue;
        const cv::Point at(SliceCanvas::margin_left + column, SliceCanvas::margin_top + row);
        image.at<cv::Vec3b>(at) = ink;
        if (line % 4 == 0) image.at<cv::Vec3b>(at + cv::Point(1, 1)) = ink;
      }
    }
  }
  return step;
}

}  // namespace clearway
