#include "apps/teach/ball_size.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

struct PlacedShape {
  const Shape* shape;
  Eigen::Isometry3d tip_from_shape;
};

/// How far the shapes reach along a direction of the tip's frame.
double extent(const std::vector<PlacedShape>& shapes, const Eigen::Vector3d& direction) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (const auto& [shape, tip_from_shape] : shapes) {
    const Eigen::Vector3d point =
        tip_from_shape * shape->support(tip_from_shape.linear().transpose() * direction);
    farthest = std::max(farthest, direction.dot(point));
  }
  return farthest;
}

/// Of the cylinder along an axis, 0, 1 or 2, of the tip's frame through the middle of the shapes.
double radius_about(int axis, const std::vector<PlacedShape>& shapes) {
  constexpr int directions = 90;
  const Eigen::Vector3d across = Eigen::Vector3d::Unit((axis + 1) % 3),
                        beside = Eigen::Vector3d::Unit((axis + 2) % 3);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& side : {across, beside})
    middle += 0.5 * (extent(shapes, side) - extent(shapes, -side)) * side;
  double radius = 0.0;
  for (int i = 0; i < directions; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / directions;
    const Eigen::Vector3d direction = std::cos(turn) * across + std::sin(turn) * beside;
    radius = std::max(radius, extent(shapes, direction) - direction.dot(middle));
  }
  return radius;
}

/// Two digits, none larger than the value.
std::string rounded_down(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return short_text(step * std::floor(value / step), 2);
}

std::string millimetres(double length) { return short_text(1e3 * length, 3) + " mm"; }

}  // namespace

double hand_radius(const VirtualRobot& robot) {
  const Robot& model = robot.robot();
  const std::vector<std::string> painted = robot.painted_parts();
  const LinkPoses poses = forward_kinematics(model, robot.middle());
  const Eigen::Isometry3d tip_from_map = tip_pose(model, robot.middle()).inverse();
  std::vector<PlacedShape> hand;
  for (const Body& body : model.bodies)
    if (std::find(painted.begin(), painted.end(), body.part) != painted.end())
      hand.push_back(
          {&body.shape, tip_from_map * poses[static_cast<std::size_t>(body.link)] * body.link_from_shape});
  if (hand.empty()) return 0.0;
  return std::min({radius_about(0, hand), radius_about(1, hand), radius_about(2, hand)}) + robot.padding();
}

std::string ball_for_voxels(double ball_radius, double resolution) {
  const double sure = std::sqrt(3.0) * resolution;  // wherever its centre is in a voxel
  if (ball_radius >= sure) return {};
  const bool is_hopeless = ball_radius < 0.5 * sure;
  return "the probe's ball, " + millimetres(ball_radius) + " in radius, " +
         (is_hopeless ? "holds no voxel" : "does not always hold a voxel") + " of " +
         millimetres(resolution) + " as a whole, and only such voxels are painted: expected a ball of " +
         millimetres(sure) + " and what tracking may be off, or --resolution " +
         rounded_down(ball_radius / std::sqrt(3.0)) + " or less";
}

std::string ball_for_hand(double ball_radius, const VirtualRobot& robot) {
  const double hand = hand_radius(robot);
  if (ball_radius >= hand) return {};
  return "the probe's ball, " + millimetres(ball_radius) + " in radius, is narrower than what of robot " +
         quote(robot.robot().name) + " has to stay in paint (" + listed(robot.painted_parts()) +
         ", a cylinder of " + millimetres(hand) +
         " in radius with padding): one stroke does not hold it, strokes side by side do";
}

}  // namespace clearway
