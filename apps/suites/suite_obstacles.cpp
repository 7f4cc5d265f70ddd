#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "apps/suites/suite_front.hpp"
#include "apps/suites/suite_reaching.hpp"

namespace clearway {
namespace {

using Eigen::Vector3d;

/// Draws one scene. Lengths are shares of the arm's reach, heights from its shoulder.
class ObstacleDrawer {
 public:
  ObstacleDrawer(const Robot& robot, const ArmReach& reach, SuiteDice dice)
      : front_(robot, reach, dice), size_(front_.size()), shoulder_(front_.shoulder()) {
    front_.add_floor();
    add_sensors();
  }

  ReachingScene take() {
    scene_.world.solids = front_.solids();
    return std::move(scene_);
  }

  void shelf() {
    const double front = between(0.48, 0.60), depth = between(0.26, 0.34);
    const double column = between(0.34, 0.44), row = between(0.34, 0.42), thick = 0.024 * size_;
    const double bottom = floor_or(shoulder_ - between(0.45, 0.6)), half = 1.5 * column;
    for (int i = 0; i <= 3; ++i) {
      const double z = bottom + i * row, y = i * column - half;
      add_box("board", {front, -half, z - thick / 2}, {front + depth, half, z + thick / 2});
      add_box("side", {front, y - thick / 2, bottom}, {front + depth, y + thick / 2, bottom + 3 * row});
    }
    add_box("back", {front + depth, -half, bottom}, {front + depth + thick, half, bottom + 3 * row});
    for (int i = 0; i < 9; ++i) {
      const Vector3d corner(front, (i % 3) * column - half, bottom + (i / 3) * row);
      add_region(corner + Vector3d(0.05 * depth, 0.25 * column, 0.25 * row),
                 corner + Vector3d(0.6 * depth, 0.75 * column, 0.75 * row), Vector3d::UnitX());
    }
  }

  void table() {
    const double top = floor_or(shoulder_ - between(0.2, 0.35)), thick = 0.04 * size_;
    const double edge = between(0.25, 0.32), half = between(0.7, 0.85);
    add_box("table", {edge, -half, top - thick}, {edge + between(0.6, 0.75), half, top});
    const int things = front_.dice().whole(3, 6);
    for (int i = 0; i < things; ++i) {
      const double aside = between(-0.55, 0.55), ahead = between(0.38, 0.85);
      const Vector3d at(ahead, aside, top);
      const double wide = between(0.08, 0.22), deep = between(0.08, 0.22), high = between(0.15, 0.45);
      add_box("thing", at - Vector3d(wide / 2, deep / 2, 0.0), at + Vector3d(wide / 2, deep / 2, high));
    }
    for (int i = 0; i < 5; ++i) {
      const double low = -0.65 * size_ + 0.26 * size_ * i;
      add_region({0.4 * size_, low, top + 0.05 * size_},
                 {0.75 * size_, low + 0.26 * size_, top + 0.2 * size_}, -Vector3d::UnitZ());
    }
  }

  void ladder() {
    const double at = between(0.45, 0.58), width = between(0.5, 0.8), bar = between(0.035, 0.06);
    const double gap = between(0.34, 0.44), bottom = floor_or(shoulder_ - between(0.55, 0.7));
    const double middle = between(-0.2, 0.2), low = middle - width / 2, high = middle + width / 2;
    for (const double y : {low, high})
      add_box("rail", {at, y - bar / 2, bottom}, {at + bar, y + bar / 2, bottom + 3 * gap});
    for (int i = 0; i <= 3; ++i) {
      const double z = bottom + i * gap;
      add_box("rung", {at, low, z - bar / 2}, {at + bar, high, z + bar / 2});
    }
    const double deep = at + 0.08 * size_, deeper = at + 0.28 * size_, aside = 0.25 * size_;
    for (int i = 0; i < 3; ++i) {
      const double z = bottom + i * gap;
      add_region({deep, low + 0.25 * width, z + 0.25 * gap}, {deeper, high - 0.25 * width, z + 0.75 * gap},
                 Vector3d::UnitX());
    }
    add_region({deep, low - aside, bottom + gap}, {deeper, low - aside / 2, bottom + 2 * gap},
               Vector3d::UnitX());
    add_region({deep, high + aside / 2, bottom + gap}, {deeper, high + aside, bottom + 2 * gap},
               Vector3d::UnitX());
  }

  void cage() {
    const double half = between(0.24, 0.32), bar = between(0.03, 0.05);
    const double above = between(-0.25, 0.1), aside = between(-0.15, 0.15), ahead = between(0.58, 0.68);
    const Vector3d middle(ahead, aside, shoulder_ + above);
    for (int axis = 0; axis < 3; ++axis) {
      front_.add_edges(middle, half, axis, bar);
      if (front_.dice().whole(0, 1) == 0) continue;  // and a bar across two opposite sides
      Vector3d low = middle, high = middle;
      low[axis] -= half, high[axis] += half;
      front_.add_bar(low, high, axis, -half, 0.0, bar);
      front_.add_bar(low, high, axis, half, 0.0, bar);
    }
    const double inner = 0.5 * half, out = half + 0.1 * size_, far = half + 0.3 * size_;
    const Vector3d in = Vector3d::Constant(inner);
    add_region(middle - in, middle + in, Vector3d::Zero());
    add_region(middle + Vector3d(-inner, out, -inner), middle + Vector3d(inner, far, inner),
               Vector3d::Zero());
    add_region(middle + Vector3d(-inner, -far, -inner), middle + Vector3d(inner, -out, inner),
               Vector3d::Zero());
    add_region(middle + Vector3d(-inner, -inner, out), middle + Vector3d(inner, inner, far),
               Vector3d::Zero());
  }

  void boxes() {
    const int count = front_.dice().whole(10, 18);
    for (int i = 0; i < count; ++i) {
      const double away = between(0.35, 0.95),
                   turn = front_.dice().between(-std::numbers::pi, std::numbers::pi);
      const Vector3d at(away * std::cos(turn), away * std::sin(turn), shoulder_ + between(-0.6, 0.7));
      const double high = between(0.05, 0.15), wide = between(0.05, 0.15), deep = between(0.05, 0.15);
      const Vector3d half(deep, wide, high);
      add_box("box", at - half, at + half);
    }
  }

 private:
  double between(double low, double high) { return front_.between(low, high); }
  double floor_or(double height) const { return front_.floor_or(height); }
  void add_box(const char* name, const Vector3d& low, const Vector3d& high) {
    front_.add_box(name, low, high);
  }
  void add_region(const Vector3d& low, const Vector3d& high, const Vector3d& approach) {
    scene_.regions.push_back({front_.map_from_front(), low, high, approach});
  }

  void add_sensors() {
    scene_.world.sensor_range = 2.5 * size_;
    for (const Vector3d& at : {Vector3d(-0.3, -0.9, 0.7), Vector3d(-0.3, 0.9, 0.3), Vector3d(1.2, 1.1, 0.1),
                               Vector3d(1.2, -1.1, -0.2)}) {
      scene_.world.sensors.push_back(front_.map_from_front() * (size_ * at + shoulder_ * Vector3d::UnitZ()));
    }
  }

  SuiteFront front_;
  double size_, shoulder_;
  ReachingScene scene_;
};

struct Kind {
  std::string_view name;
  void (ObstacleDrawer::*draw)();
};
constexpr Kind kinds[] = {{"shelf", &ObstacleDrawer::shelf},
                          {"table", &ObstacleDrawer::table},
                          {"ladder", &ObstacleDrawer::ladder},
                          {"cage", &ObstacleDrawer::cage},
                          {"boxes", &ObstacleDrawer::boxes}};

}  // namespace

ReachingScene draw_obstacles(std::string_view kind, const Robot& robot, const ArmReach& reach,
                             std::uint64_t seed, std::size_t index) {
  for (const Kind& known : kinds) {
    if (known.name != kind) continue;
    ObstacleDrawer drawer(robot, reach, SuiteDice(seed, 2 * index));
    (drawer.*known.draw)();
    return drawer.take();
  }
  throw std::invalid_argument("scene kind '" + std::string(kind) +
                              "': expected shelf, table, ladder, cage or boxes");
}

}  // namespace clearway
