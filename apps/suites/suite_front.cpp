#include "apps/suites/suite_front.hpp"

#include <algorithm>

#include "apps/suites/suite_draws.hpp"

namespace clearway {

using Eigen::Vector3d;

SuiteFront::SuiteFront(const Robot& robot, const ArmReach& reach, SuiteDice dice)
    : robot_(robot), size_(reach.length), shoulder_(reach.height), dice_(dice) {
  const double turn = dice_.between(-0.5, 0.5);
  map_from_front_ = robot_.map_from_base * Eigen::AngleAxisd(turn, Vector3d::UnitZ());
}

double SuiteFront::floor_or(double height) const { return std::max(height, 0.06 * size_); }

std::string SuiteFront::numbered(const std::string& name) const {
  return name + " " + std::to_string(solids_.size());
}

void SuiteFront::add_floor() {
  const double wide = 1.2 * size_;
  add_box("floor", {-wide, -wide, -0.05 * size_}, {wide, wide, -0.01 * size_});
}

void SuiteFront::add_box(const std::string& name, const Vector3d& low, const Vector3d& high) {
  solids_.push_back(box_between(numbered(name), map_from_front_, low, high));
}

void SuiteFront::add_bar(Vector3d low, Vector3d high, int axis, double u, double v, double bar) {
  for (Vector3d* end : {&low, &high}) (*end)[(axis + 1) % 3] += u, (*end)[(axis + 2) % 3] += v;
  add_box("bar", low - Vector3d::Constant(bar / 2), high + Vector3d::Constant(bar / 2));
}

void SuiteFront::add_edges(const Vector3d& middle, double half, int axis, double bar) {
  Vector3d low = middle, high = middle;
  low[axis] -= half, high[axis] += half;
  for (int edge = 0; edge < 4; ++edge)
    add_bar(low, high, axis, edge % 2 == 0 ? -half : half, edge / 2 == 0 ? -half : half, bar);
}

void SuiteFront::add_can(const std::string& name, const Vector3d& foot, double radius, double height) {
  SceneShape can;
  can.name = numbered(name);
  can.geometry = CylinderShape{radius, height};
  can.map_from_shape = map_from_front_ * Eigen::Translation3d(foot + height / 2 * Vector3d::UnitZ());
  solids_.push_back(can);
}

}  // namespace clearway
