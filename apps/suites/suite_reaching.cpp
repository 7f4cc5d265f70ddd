#include "apps/suites/suite_reaching.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "apps/suites/suite_draws.hpp"
#include "apps/suites/suite_world.hpp"

namespace clearway {
namespace {

constexpr int most_reach_draws = 50000;
constexpr double widest_tilt = 50.0 * std::numbers::pi / 180.0;

/// Which way the hand points: from its link to the tip, map frame.
Eigen::Vector3d pointing(const Robot& robot, const Configuration& q) {
  const Eigen::Vector3d tip = robot.link_from_tip.translation();
  const Eigen::Vector3d own = tip.isZero() ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(tip.normalized());
  return tip_pose(robot, q).linear() * robot.link_from_tip.linear().transpose() * own;
}

/// Draws ends and problems in one scene.
class ProblemDrawer {
 public:
  ProblemDrawer(const ConfigurationSpace& space, const std::vector<TipRegion>& regions, SuiteDice dice)
      : space_(space), regions_(regions), solver_(space.robot()), dice_(dice) {
    solver_.inverse_kinematics = "numeric";  // for the tip's position alone
  }

  std::optional<StageProblem> draw() {
    const Configuration anywhere = draw_configuration(space_.robot(), dice_);
    const int count = static_cast<int>(regions_.size());
    const int from = count > 0 ? dice_.whole(0, count - 1) : -1;
    const auto start = end_in(from, anywhere);
    if (!start) return std::nullopt;
    const bool is_near = dice_.whole(0, 1) == 0;
    for (int attempt = 0; attempt < 10; ++attempt) {
      const int to = count > 0 ? (from + dice_.whole(1, count - 1)) % count : -1;
      const Configuration other = draw_configuration(space_.robot(), dice_);
      const double share = count > 0 && is_near ? 0.0 : 0.5;
      const auto goal = end_in(to, *start + share * (other - *start));
      if (goal && !space_.is_edge_free(*start, *goal)) return StageProblem{"", *start, {*goal}};
    }
    return std::nullopt;
  }

 private:
  /// A free configuration with the tip in that region (-1: anywhere), near `near`.
  std::optional<Configuration> end_in(int index, const Configuration& near) {
    if (index < 0) return space_.is_free(near) ? std::optional(near) : std::nullopt;
    const TipRegion& region = regions_[static_cast<std::size_t>(index)];
    Eigen::Vector3d at;
    for (int k = 0; k < 3; ++k) at[k] = dice_.between(region.low[k], region.high[k]);
    const Eigen::Isometry3d tip(Eigen::Translation3d(region.map_from_region * at));
    const auto q =
        inverse_kinematics(solver_, tip, near, {.max_iterations = 50, .restarts = 0, .position_only = true});
    if (!q || !space_.is_free(*q)) return std::nullopt;
    if (region.approach.isZero()) return q;
    const Eigen::Vector3d wanted = region.map_from_region.linear() * region.approach;
    return pointing(space_.robot(), *q).dot(wanted) >= std::cos(widest_tilt) ? q : std::nullopt;
  }

  const ConfigurationSpace& space_;
  const std::vector<TipRegion>& regions_;
  Robot solver_;
  SuiteDice dice_;
};

}  // namespace

ArmReach arm_reach(const Robot& robot) {
  SuiteDice dice(1, 0);
  ArmReach reach;
  const Eigen::Isometry3d base_from_map = robot.map_from_base.inverse();
  for (int draw = 0; draw < 4000; ++draw) {
    const Eigen::Vector3d tip =
        base_from_map * tip_pose(robot, draw_configuration(robot, dice)).translation();
    if (tip.head<2>().norm() <= reach.length) continue;
    reach = {tip.head<2>().norm(), tip.z()};
  }
  return reach;
}

ReachingScene draw_reaching(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                            const Policies& policies, double padding) {
  ReachingScene scene = draw_obstacles(generator.kind, robot, arm_reach(robot), generator.seed, index);
  scene.world.name = generator.kind + " " + std::to_string(index + 1);
  scene.world.resolution = generator.resolution;
  scene.map = make_map(scene.world, robot.critical_parts);
  const ConfigurationSpace space(robot, scene.map, policies, {.padding = padding});
  ProblemDrawer drawer(space, scene.regions, SuiteDice(generator.seed, 2 * index + 1));
  scene.problems = draw_problems(generator, index, problems_of_a_scene, most_reach_draws, scene.world.name,
                                 space, [&] { return drawer.draw(); });
  return scene;
}

}  // namespace clearway
