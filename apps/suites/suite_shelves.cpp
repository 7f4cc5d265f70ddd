#include "apps/suites/suite_shelves.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include "apps/suites/suite_draws.hpp"
#include "apps/suites/suite_world.hpp"

namespace clearway {
namespace {

constexpr int most_shelf_draws = 20000;
constexpr int rows = 3, columns = 3;
constexpr double wall = 0.05, board = 0.024;  ///< thickness, metres at full size

/// A shelf: its front faces the arm, its frame stands on the floor in the middle of the front, x into it.
struct ShelfPlan {
  Eigen::Isometry3d map_from_shelf = Eigen::Isometry3d::Identity();
  double depth = 0.0, column = 0.0, row = 0.0;  ///< metres: of the shelf, and of a compartment
  double bottom = 0.0;                          ///< height of its lowest board
};

ShelfPlan draw_plan(const Robot& robot, SuiteDice& dice) {
  const double s = robot.scale;
  ShelfPlan plan;
  const double turn = dice.between(-0.4, 0.4), away = s * dice.between(0.50, 0.62);
  plan.map_from_shelf = robot.map_from_base * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                        Eigen::Translation3d(away, 0.0, 0.0);
  plan.depth = s * dice.between(0.28, 0.36);
  plan.column = s * dice.between(0.36, 0.46);
  plan.row = s * dice.between(0.34, 0.42);
  plan.bottom = s * dice.between(0.22, 0.36);
  return plan;
}

void add_shelf(const ShelfPlan& plan, double scale, std::vector<SceneShape>& solids) {
  const double half = columns * plan.column / 2.0, thick = scale * board / 2.0;
  const double top = plan.bottom + rows * plan.row;
  for (int row = 0; row <= rows; ++row) {
    const double z = plan.bottom + row * plan.row;
    solids.push_back(box_between("board " + std::to_string(row), plan.map_from_shelf, {0.0, -half, z - thick},
                                 {plan.depth, half, z + thick}));
  }
  for (int column = 0; column <= columns; ++column) {
    const double y = column * plan.column - half;
    solids.push_back(box_between("side " + std::to_string(column), plan.map_from_shelf, {0.0, y - thick, 0.0},
                                 {plan.depth, y + thick, top}));
  }
  solids.push_back(box_between("back", plan.map_from_shelf, {plan.depth, -half, 0.0},
                               {plan.depth + 2.0 * thick, half, top}));
}

/// A floor and four walls around the arm.
void add_room(const Robot& robot, std::vector<SceneShape>& solids) {
  const double s = robot.scale, front = 1.55 * s, back = -1.25 * s, side = 1.55 * s, top = 2.2 * s;
  const double w = wall * s;
  const Eigen::Isometry3d& base = robot.map_from_base;
  solids.push_back(box_between("floor", base, {back, -side, -w}, {front, side, -0.007 * s}));
  solids.push_back(box_between("left wall", base, {back, side, 0.0}, {front, side + w, top}));
  solids.push_back(box_between("right wall", base, {back, -side - w, 0.0}, {front, -side, top}));
  solids.push_back(box_between("front wall", base, {front, -side, 0.0}, {front + w, side, top}));
  solids.push_back(box_between("back wall", base, {back - w, -side, 0.0}, {back, side, top}));
}

SuiteWorld shelf_world(const std::string& name, double resolution, const Robot& robot,
                       const ShelfPlan& plan) {
  const double s = robot.scale;
  SuiteWorld world;
  world.name = name;
  world.resolution = resolution;
  add_room(robot, world.solids);
  add_shelf(plan, s, world.solids);
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(-0.2, -0.9, 1.5), Eigen::Vector3d(-0.2, 0.9, 0.4)}) {
    world.sensors.push_back(robot.map_from_base * (s * at));
  }
  world.sensor_range = 3.5 * s;
  return world;
}

/// A place for the tip in that compartment.
Eigen::Isometry3d draw_tip(const ShelfPlan& plan, int compartment, SuiteDice& dice) {
  const double y = (compartment % columns + dice.between(0.25, 0.75)) * plan.column;
  const double z = plan.bottom + (compartment / columns + dice.between(0.25, 0.75)) * plan.row;
  const Eigen::Translation3d place(dice.between(0.15, 0.7) * plan.depth, y - columns * plan.column / 2.0, z);
  const double tilt = dice.between(0.0, 35.0 * degree), about = dice.between(0.0, 2.0 * std::numbers::pi);
  const double roll = dice.between(0.0, 2.0 * std::numbers::pi);
  return plan.map_from_shelf * place * Eigen::AngleAxisd(90.0 * degree, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(about, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
}

/// A problem between two compartments, or none when this draw gave none.
std::optional<StageProblem> draw_problem(const ConfigurationSpace& space, const ShelfPlan& plan,
                                         SuiteDice& dice) {
  const IkOptions few{.restarts = 2};
  const int from = dice.whole(0, rows * columns - 1);
  const int to = (from + dice.whole(1, rows * columns - 1)) % (rows * columns);
  const Configuration near = draw_configuration(space.robot(), dice);
  const auto start = inverse_kinematics(space.robot(), draw_tip(plan, from, dice), near, few);
  if (!start || !space.is_free(*start)) return std::nullopt;
  for (int attempt = 0; attempt < 10; ++attempt) {
    const auto goal = inverse_kinematics(space.robot(), draw_tip(plan, to, dice), *start, few);
    if (goal && space.is_free(*goal) && !space.is_edge_free(*start, *goal))
      return StageProblem{"", *start, {*goal}};
  }
  return std::nullopt;
}

}  // namespace

Shelf draw_shelf(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                 const Policies& policies, double padding) {
  SuiteDice dice(generator.seed, index);
  const ShelfPlan plan = draw_plan(robot, dice);
  Shelf shelf;
  shelf.world = shelf_world("shelf " + std::to_string(index + 1), generator.resolution, robot, plan);
  shelf.map = make_map(shelf.world, robot.critical_parts);
  const ConfigurationSpace space(robot, shelf.map, policies, {.padding = padding});
  shelf.problems = draw_problems(generator, index, problems_of_a_shelf, most_shelf_draws, shelf.world.name,
                                 space, [&] { return draw_problem(space, plan, dice); });
  return shelf;
}

}  // namespace clearway
