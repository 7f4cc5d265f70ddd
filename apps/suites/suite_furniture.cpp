#include "apps/suites/suite_furniture.hpp"

#include <algorithm>
#include <array>

#include "apps/suites/suite_front.hpp"

namespace clearway {
namespace {

using Eigen::Vector3d;

const Vector3d ahead = Vector3d::UnitX(), down = -Vector3d::UnitZ();

/// The attempt from which on scenes stand on the floor at least: of an arm with a low shoulder a cage may be
/// in it, and scenes that held problems stay as they are.
constexpr int first_lifted = 5;

/// Draws one scene. Lengths are shares of the arm's reach.
class FurnitureDrawer {
 public:
  /// @param is_lifted it stands on the floor at least
  FurnitureDrawer(const Robot& robot, SuiteDice dice, bool is_lifted)
      : front_(robot, arm_reach(robot), dice),
        size_(front_.size()),
        shoulder_(front_.shoulder()),
        is_lifted_(is_lifted) {
    front_.add_floor();
  }

  void take(FurnitureScene& scene) {
    scene.solids = front_.solids();
    scene.places = places_;
  }

  void thin_bookshelf() { bookshelf(3, 3, between(0.24, 0.30), between(0.32, 0.38)); }
  void tall_bookshelf() { bookshelf(2, 4, between(0.42, 0.52), between(0.27, 0.33)); }

  /// Bars all around, closer on the side that faces the arm, and things on a plate in it.
  void cage() {
    const double half = between(0.20, 0.26), bar = between(0.02, 0.03);
    Vector3d middle(between(0.55, 0.65), between(-0.15, 0.15), shoulder_ + between(-0.2, 0.1));
    if (is_lifted_) middle.z() = floor_or(middle.z() - half) + half;
    for (int axis = 0; axis < 3; ++axis) front_.add_edges(middle, half, axis, bar);
    const Vector3d up = half * Vector3d::UnitZ(), aside = half * Vector3d::UnitY();
    for (const double side : {-1.0, 1.0}) {  // and upright bars in the middle of its sides
      front_.add_bar(middle - up + side * aside, middle + up + side * aside, 2, 0.0, 0.0, bar);
      if (roll(2)) front_.add_bar(middle - aside, middle + aside, 1, 0.0, side * half, bar);
    }
    const double bottom = middle.z() - half;
    box("plate", middle + Vector3d(-half, -half, -half - 0.02 * size_), middle + Vector3d(half, half, -half));
    for (const double across : {-0.5, 0.0, 0.5}) {
      const Vector3d foot(middle.x() + between(-0.3, 0.3) * half / size_, middle.y() + across * half, bottom);
      thing(foot, {ahead, down});
    }
  }

  /// An open box on a stand, with things to pick out of it from above.
  void box_of_things() {
    const double long_side = between(0.20, 0.28), wide = between(0.18, 0.24), high = between(0.16, 0.26);
    const double wall = between(0.015, 0.025), top = floor_or(shoulder_ - between(0.35, 0.55));
    const Vector3d middle(between(0.50, 0.62), between(-0.25, 0.25), top);
    box("stand", middle + Vector3d(-0.3 * size_, -0.3 * size_, -0.04 * size_),
        middle + Vector3d(0.3 * size_, 0.3 * size_, 0.0));
    for (const double side : {-1.0, 1.0}) {
      const Vector3d x(side * long_side, 0.0, 0.0), y(0.0, side * wide, 0.0);
      box("wall", middle + x - Vector3d(wall / 2, wide, 0.0), middle + x + Vector3d(wall / 2, wide, high));
      box("wall", middle + y - Vector3d(long_side, wall / 2, 0.0),
          middle + y + Vector3d(long_side, wall / 2, high));
    }
    for (int i = 0; i < 4; ++i) {
      const Vector3d in(front_.dice().between(-0.6, 0.6) * long_side, front_.dice().between(-0.6, 0.6) * wide,
                        0.0);
      thing(middle + in, {down});
    }
    place(middle + Vector3d(0.0, (middle.y() > 0.0 ? -0.5 : 0.5) * size_, 0.2 * size_), down);
  }

  /// A table full of things: cans to pick, boxes in the way.
  void table() {
    const double top = floor_or(shoulder_ - between(0.2, 0.4)), edge = between(0.22, 0.30);
    slab("table", edge, edge + between(0.55, 0.70), between(0.6, 0.8), top, 0.04 * size_);
    for (int i = 0; i < 5; ++i) {
      const Vector3d foot(edge + between(0.10, 0.45), between(-0.5, 0.5), top);
      thing(foot, {ahead, down});
    }
    for (int i = 0; i < 3; ++i) {
      const Vector3d foot(edge + between(0.10, 0.45), between(-0.5, 0.5), top);
      const Vector3d half(between(0.03, 0.08), between(0.03, 0.08), 0.0);
      box("box", foot - half, foot + half + Vector3d(0.0, 0.0, between(0.10, 0.30)));
    }
  }

  /// Things on a shelf under a table with four legs.
  void under_table() {
    const double low = floor_or(shoulder_ - between(0.45, 0.55)), top = low + between(0.34, 0.44);
    const double near = between(0.35, 0.42), far = near + between(0.40, 0.5), half = between(0.45, 0.6);
    slab("top", near, far, half, top, 0.03 * size_);
    slab("shelf", near, far, half, low, 0.03 * size_);
    const double leg = 0.02 * size_;
    for (const double x : {near + leg, far - leg}) {
      for (const double y : {leg - half, half - leg})
        box("leg", {x - leg, y - leg, 0.0}, {x + leg, y + leg, top - 0.03 * size_});
    }
    for (int i = 0; i < 4; ++i) thing({near + between(0.08, 0.25), between(-0.3, 0.3), low}, {ahead});
    place({near + between(0.1, 0.3), between(-0.3, 0.3), top + 0.1 * size_}, down);  // and on it
  }

  /// A counter with a sink, a cabinet without doors above it, an oven beside it.
  void kitchen() {
    const double top = floor_or(shoulder_ - between(0.25, 0.35)), edge = between(0.34, 0.40);
    const double deep = between(0.34, 0.40), sink = 0.3 * size_, thick = 0.03 * size_;
    box("counter", {edge, sink / 2, 0.0}, {edge + deep, 0.75 * size_, top});
    box("counter", {edge, -0.75 * size_, 0.0}, {edge + deep, -sink / 2, top});
    const double basin = std::max(top - between(0.12, 0.18), 0.02 * size_);
    box("sink", {edge, -sink / 2, 0.0}, {edge + deep, sink / 2, basin});
    box("back", {edge + deep, -0.75 * size_, 0.0}, {edge + deep + thick, 0.75 * size_, top + 0.9 * size_});
    const double bottom = top + between(0.36, 0.44), room = between(0.26, 0.32);
    const double front = edge + deep - between(0.24, 0.28), half = 0.45 * size_;
    for (int i = 0; i <= 2; ++i)
      box("board", {front, -half, bottom + i * room}, {edge + deep, half, bottom + i * room + thick / 2});
    for (const double y : {-half, 0.0, half})
      box("side", {front, y - thick / 4, bottom}, {edge + deep, y + thick / 4, bottom + 2 * room});
    for (const double y : {-0.5 * half, 0.5 * half}) {
      for (const int row : {0, 1})
        thing({front + between(0.06, 0.12), y, bottom + row * room + thick / 2}, {ahead});
    }
    for (const double side : {-1.0, 1.0})
      thing({edge + between(0.08, 0.16), side * between(0.25, 0.55), top}, {ahead, down});
  }

 private:
  double between(double low, double high) { return front_.between(low, high); }
  double floor_or(double height) const { return front_.floor_or(height); }
  bool roll(int sides) { return front_.dice().whole(1, sides) == 1; }
  void box(const char* name, const Vector3d& low, const Vector3d& high) { front_.add_box(name, low, high); }

  /// A board that reaches as far to the left as to the right. @param top of it
  void slab(const char* name, double near, double far, double half, double top, double thick) {
    box(name, {near, -half, top - thick}, {far, half, top});
  }

  /// The place before a point of the front frame.
  void place(const Vector3d& at, const Vector3d& approach) {
    const Eigen::Isometry3d& front = front_.map_from_front();
    places_.push_back({front * at, front.linear() * approach});
  }

  /// A can to take hold of, or just the place for one. @param ways how the hand may come
  void thing(const Vector3d& foot, const std::vector<Vector3d>& ways) {
    const double radius = between(0.010, 0.022), height = between(0.08, 0.16);
    if (!roll(4)) front_.add_can("can", foot, radius, height);
    for (const Vector3d& way : ways) {
      const double grip = way.z() < 0.0 ? height - 0.02 * size_ : 0.7 * height;
      place(foot + grip * Vector3d::UnitZ(), way);
    }
  }

  void bookshelf(int columns, int rows, double column, double row) {
    const double front = between(0.46, 0.56), depth = between(0.22, 0.28), thick = 0.02 * size_;
    const double bottom = floor_or(shoulder_ - between(0.45, 0.60)), half = 0.5 * columns * column;
    for (int i = 0; i <= rows; ++i) {
      const double z = bottom + i * row;
      box("board", {front, -half, z - thick / 2}, {front + depth, half, z + thick / 2});
    }
    for (int i = 0; i <= columns; ++i) {
      const double y = i * column - half;
      box("side", {front, y - thick / 2, bottom}, {front + depth, y + thick / 2, bottom + rows * row});
    }
    box("back", {front + depth, -half, bottom}, {front + depth + thick, half, bottom + rows * row});
    for (int i = 0; i < rows * columns; ++i) {
      const double y = (i % columns + front_.dice().between(0.35, 0.65)) * column - half;
      thing({front + between(0.05, 0.14), y, bottom + (i / columns) * row + thick / 2}, {ahead});
    }
  }

  SuiteFront front_;
  double size_, shoulder_;
  bool is_lifted_;
  std::vector<GraspPlace> places_;
};

struct FurnitureKind {
  const char* name;
  void (FurnitureDrawer::*draw)();
};
constexpr std::array furniture_kinds = {FurnitureKind{"thin bookshelf", &FurnitureDrawer::thin_bookshelf},
                                        FurnitureKind{"tall bookshelf", &FurnitureDrawer::tall_bookshelf},
                                        FurnitureKind{"cage", &FurnitureDrawer::cage},
                                        FurnitureKind{"box", &FurnitureDrawer::box_of_things},
                                        FurnitureKind{"table", &FurnitureDrawer::table},
                                        FurnitureKind{"under table", &FurnitureDrawer::under_table},
                                        FurnitureKind{"kitchen", &FurnitureDrawer::kitchen}};

}  // namespace

FurnitureScene draw_furniture(const Robot& robot, std::uint64_t seed, std::size_t index, int attempt) {
  const FurnitureKind& kind = furniture_kinds[index % furniture_kinds.size()];
  FurnitureDrawer drawer(robot, SuiteDice(seed, 1000 * index + static_cast<std::uint64_t>(attempt)),
                         attempt >= first_lifted);
  (drawer.*kind.draw)();
  FurnitureScene scene;
  scene.name = std::string(kind.name) + " " + std::to_string(index / furniture_kinds.size() + 1);
  drawer.take(scene);
  return scene;
}

}  // namespace clearway
