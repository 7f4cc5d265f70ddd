#include "apps/bench/beam_scenes.hpp"

#include <numbers>

#include "apps/bench/arm_worlds.hpp"

namespace clearway::bench {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A room about the arm, scanned, and balls of `radius` painted where `centers` says.
Snapshot scanned_room(double resolution, const Robot& robot, const std::vector<Sphere>& painted) {
  const ArmWorld room{.resolution = resolution, .half = 1.4, .balls = 0, .gap = 2.0 * resolution};
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : room.scans()) map.insert(scan);
  const int volume = map.add_volume("free", robot.critical_parts);
  for (const Sphere& ball : painted) map.paint(volume, ball);
  return map.snapshot();
}

BeamScene scene(const std::string& name, double resolution, double hole) {
  BeamScene scene{name, load_robot("puma560"), {}, {}, {}};
  Configuration start(6);
  start << 0.0, -0.8, 0.3, 0.0, 0.4, 0.0;
  scene.start = start;
  scene.goal = start;
  scene.goal[0] += 43.0 * degree, scene.goal[1] += 20.0 * degree, scene.goal[4] -= 11.3 * degree;
  const auto tip = [&](double t) {
    return tip_pose(scene.robot, start + t * (scene.goal - start)).translation().eval();
  };
  const Sphere pocket{tip(0.5), hole};
  Dice dice(1);
  std::vector<Sphere> painted;
  while (painted.size() < 600) {
    const Eigen::Vector3d aside(dice.between(-0.25, 0.25), dice.between(-0.25, 0.25),
                                dice.between(-0.25, 0.25));
    const Sphere ball{tip(dice.between(-0.1, 1.1)) + aside, dice.between(0.15, 0.25)};
    if (hole > 0.0 && (ball.center - pocket.center).norm() < ball.radius + pocket.radius) continue;
    painted.push_back(ball);
  }
  scene.map = scanned_room(resolution, scene.robot, painted);
  return scene;
}

}  // namespace

BeamScene compact_scene(double resolution) { return scene("compact", resolution, 0.0); }
BeamScene holed_scene(double resolution) { return scene("holed", resolution, 0.08); }

}  // namespace clearway::bench
