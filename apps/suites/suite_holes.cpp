#include "apps/suites/suite_holes.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_draws.hpp"
#include "apps/suites/suite_hand.hpp"
#include "apps/suites/suite_world.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr int most_hole_draws = 20000;
constexpr int most_hole_maps = 500;  ///< of these that are painted, which takes far longer

/// Radii of pockets, in radii of the hand's sphere.
std::pair<double, double> pocket_radii(const SuiteGenerator& generator) {
  return generator.kind == "large_holes" ? std::pair(0.6, 1.5) : std::pair(0.1, 0.6);
}

class HoleDrawer {
 public:
  HoleDrawer(const SuiteGenerator& generator, std::size_t index, const Robot& robot)
      : robot_(robot),
        hand_(robot, generator.kind),
        bare_(robot, Snapshot(), {.parts = {}, .critical_by_default = false}),
        radii_(pocket_radii(generator)),
        dice_(generator.seed, index) {}

  /// Ends that the robot can go between where nothing is; nothing when this draw gave none.
  std::optional<std::pair<Configuration, Configuration>> ends() {
    Configuration start(static_cast<Eigen::Index>(robot_.dof()));
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      const double low = std::max(robot_.joints[j].lower, -std::numbers::pi);
      const double high = std::min(robot_.joints[j].upper, std::numbers::pi);
      start[static_cast<Eigen::Index>(j)] = low + dice_.between(0.1, 0.9) * (high - low);
    }
    Configuration goal = start;
    const double side = dice_.between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    goal[0] += side * dice_.between(35.0, 50.0) * degree;
    for (Eigen::Index j = 1; j < goal.size(); ++j) goal[j] += dice_.between(-8.0, 8.0) * degree;
    const Sphere from = hand_.sphere(start), to = hand_.sphere(goal);
    if ((to.center - from.center).norm() < 3.0 * from.radius) return std::nullopt;  // it hardly moves
    if (!bare_.is_edge_free(start, goal)) return std::nullopt;
    return std::pair(start, goal);
  }

  /// Spheres in turn along the straight way between the ends.
  std::vector<SuiteSphere> spheres(const Configuration& start, const Configuration& goal) {
    const int count = dice_.whole(300, 800);
    std::vector<SuiteSphere> spheres;
    for (int i = 0; i < count; ++i) {
      const Sphere hand = hand_.sphere(start + static_cast<double>(i) / (count - 1) * (goal - start));
      const Eigen::Vector3d at = hand.center + aside(2.3 * hand.radius);
      spheres.push_back({at, dice_.between(1.25, 2.0) * hand.radius});
    }
    return spheres;
  }

  SuiteSphere pocket(const Configuration& start, const Configuration& goal) {
    const Sphere hand = hand_.sphere(start + dice_.between(1.0, 2.0) / 3.0 * (goal - start));
    const Eigen::Vector3d at = hand.center + aside(0.5 * hand.radius);
    return {at, dice_.between(radii_.first, radii_.second) * hand.radius};
  }

 private:
  Eigen::Vector3d aside(double most) {
    const double x = dice_.between(-most, most), y = dice_.between(-most, most);
    return {x, y, dice_.between(-most, most)};
  }

  const Robot& robot_;
  SuiteHand hand_;
  ConfigurationSpace bare_;
  std::pair<double, double> radii_;
  SuiteDice dice_;
};

}  // namespace

Hole draw_hole(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
               const Policies& policies, double padding) {
  HoleDrawer drawer(generator, index, robot);
  std::string drawn = "for robot " + quote(robot.name);  // with its policies once a map is made
  for (int draw = 0, maps = 0; draw < most_hole_draws && maps < most_hole_maps; ++draw) {
    const auto ends = drawer.ends();
    if (!ends) continue;
    ++maps;
    const auto& [start, goal] = *ends;
    Hole hole{.world = {}, .map = {}, .start = start, .goal = goal};
    hole.world.name = "hole " + std::to_string(index + 1);
    hole.world.resolution = generator.resolution;
    hole.world.volumes.push_back({"free", {}, {drawer.spheres(start, goal)}});
    const SuiteSphere pocket = drawer.pocket(start, goal);
    const auto space_of = [&](const Snapshot& map) {
      return ConfigurationSpace(robot, map, policies, {.padding = padding});
    };
    const ConfigurationSpace painted = space_of(make_map(hole.world, robot.critical_parts));
    drawn = drawn_for(painted);
    if (!painted.is_edge_free(start, goal)) continue;
    hole.world.pockets = {pocket};
    hole.map = make_map(hole.world, robot.critical_parts);
    const ConfigurationSpace space = space_of(hole.map);
    if (space.is_free(start) && space.is_free(goal) && !space.is_edge_free(start, goal)) return hole;
  }
  throw DrawnInVain(generator.kind + ": no volume found " + drawn + " in " + grouped(most_hole_draws) +
                    " draws of ends and " + grouped(most_hole_maps) + " of paint");
}

}  // namespace clearway
