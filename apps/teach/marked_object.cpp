#include "apps/teach/marked_object.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace clearway {
namespace {

constexpr int sides = 16;
constexpr double aside = 1e-5;  ///< m above a border of voxels: surely not on it

/// Where the object stands, as MarkedObject has it.
double plane_below(const std::vector<MarkingBall>& balls, double resolution) {
  double high = std::numeric_limits<double>::infinity(), low = high;
  for (const MarkingBall& ball : balls) {
    const double touched = ball.center.z() - ball.radius;
    if (touched + ball.bound >= high) continue;
    high = touched + ball.bound;
    low = touched - ball.bound;
  }
  const double first =
      std::ceil(high / resolution) * resolution;  // bottom of the first row that is surely above
  return std::max(low, first - resolution + aside);
}

/// Farthest of all balls along a direction in the plane.
double reach(const std::vector<MarkingBall>& balls, const Eigen::Vector2d& direction) {
  double most = -std::numeric_limits<double>::infinity();
  for (const MarkingBall& ball : balls)
    most = std::max(most, ball.center.head<2>().dot(direction) + ball.painted);
  return most;
}

Eigen::Vector2d side(int k) {
  const double angle = 2.0 * std::numbers::pi * k / sides;
  return {std::cos(angle), std::sin(angle)};
}

/// Where neighbouring sides of the smallest prism round all balls meet.
std::vector<Eigen::Vector2d> outline(const std::vector<MarkingBall>& balls) {
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < sides; ++k) {
    Eigen::Matrix2d normals;
    normals << side(k).transpose(), side(k + 1).transpose();
    corners.push_back(normals.inverse() * Eigen::Vector2d(reach(balls, side(k)), reach(balls, side(k + 1))));
  }
  return corners;
}

}  // namespace

MarkedObject marked_object(const std::vector<MarkingBall>& balls, double resolution) {
  if (balls.empty()) throw std::invalid_argument("no image of the ball was accepted in the stroke");
  const double bottom = plane_below(balls, resolution);
  double top = -std::numeric_limits<double>::infinity();
  for (const MarkingBall& ball : balls) top = std::max(top, ball.center.z() + ball.painted);
  if (!(top > bottom + resolution))
    throw std::invalid_argument("the stroke is no higher than a voxel; lead the ball round the object");
  const std::vector<Eigen::Vector2d> corners = outline(balls);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector2d& corner : corners)
    for (const double z : {bottom, top}) box.extend(Eigen::Vector3d(corner.x(), corner.y(), z));
  MarkedObject object;
  object.map_from_object.translation() = box.center();
  std::vector<Eigen::Vector3d> vertices;
  for (const Eigen::Vector2d& corner : corners)
    for (const double z : {bottom, top})
      vertices.push_back(Eigen::Vector3d(corner.x(), corner.y(), z) - box.center());
  object.load.shape = Shape::convex(std::move(vertices));
  return object;
}

}  // namespace clearway
