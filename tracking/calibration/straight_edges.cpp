#include "tracking/calibration/straight_edges.hpp"

#include <cmath>

#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

/// A line, by how far it lies along the normal from where it would be.
struct MovedLine {
  Eigen::Vector2d normal;
  double by = 0.0;
};

/// How far the point moves in which two lines meet.
Eigen::Vector2d meeting_moved(const MovedLine& a, const MovedLine& b) {
  const double across = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  constexpr double least = 0.1;  // of a tag seen nearly from its side
  if (std::abs(across) < least) return Eigen::Vector2d::Zero();
  return Eigen::Vector2d(a.by * b.normal.y() - b.by * a.normal.y(),
                         b.by * a.normal.x() - a.by * b.normal.x()) /
         across;
}

}  // namespace

std::optional<std::array<Eigen::Vector2d, 4>> corners_by_straight_edges(
    const Camera& camera, const MountedTag& tag, const BoardBend& bend,
    const Eigen::Isometry3d& camera_from_board) {
  const auto in_tag = tag_corners(tag.size);
  const auto seen = [&](const Eigen::Vector3d& point) {
    return camera.project(camera_from_board * bend.bent(tag.body_from_tag * point));
  };
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = seen(in_tag[i]);
    if (!pixel) return std::nullopt;
    corners[i] = *pixel;
  }
  std::array<MovedLine, 4> edges;  // from each corner to the next
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const auto middle = seen(0.5 * (in_tag[i] + in_tag[next]));
    if (!middle) return std::nullopt;
    const Eigen::Vector2d along = (corners[next] - corners[i]).normalized();
    edges[i].normal = Eigen::Vector2d(along.y(), -along.x());
    // The mean height of a parabola over its chord, at apriltag's 16 points: 2/3 * 18/17 of its middle's.
    constexpr double mean_height = 0.706;
    edges[i].by = mean_height * edges[i].normal.dot(*middle - corners[i]);
  }
  std::array<Eigen::Vector2d, 4> found = corners;
  for (std::size_t i = 0; i < 4; ++i) found[i] += meeting_moved(edges[(i + 3) % 4], edges[i]);
  return found;
}

}  // namespace clearway
