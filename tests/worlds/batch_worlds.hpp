#pragma once

// Robots among blocked voxels, for what looks at many configurations at once.

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/robot_files/load_robot.hpp"
#include "planning/space/collision_model.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway::worlds {

/// The same robot with the hull of some sixty points of its surface for each body.
inline Robot of_hulls(Robot robot) {
  for (Body& body : robot.bodies) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 60; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / 60.0, around = std::sqrt(1.0 - z * z), angle = 2.4 * i;
      points.push_back(body.shape.support({around * std::cos(angle), around * std::sin(angle), z}));
    }
    body.shape = Shape::convex(points);
    body.cover = body.shape.sphere_cover();
    for (Sphere& sphere : body.cover) sphere.center = body.link_from_shape * sphere.center;
  }
  robot.name += " of hulls";
  return robot;
}

/// Those that come with the program, one of them with hulls, and small ones with mimic joints, slides and two
/// arms.
inline std::vector<Robot> robots_of_all_kinds() {
  std::vector<Robot> robots;
  for (const char* name : {"puma560", "panda", "arm5", "planar2"}) robots.push_back(load_robot(name));
  robots.push_back(of_hulls(robots.front()));
  robots.push_back(whip().robot());
  robots.push_back(telescope().robot());
  robots.push_back(rack_and_pinion().robot());
  robots.push_back(scissors().robot());
  return robots;
}

/// The robot in all of these is more than 10 cm away from the point.
inline bool keep_away(const Robot& robot, const std::vector<Configuration>& homes,
                      const Eigen::Vector3d& point) {
  for (const Configuration& home : homes) {
    const LinkPoses poses = forward_kinematics(robot, home);
    for (const Body& body : robot.bodies) {
      for (const Sphere& sphere : body.cover) {
        const Eigen::Vector3d center = poses[static_cast<std::size_t>(body.link)] * sphere.center;
        if ((center - point).norm() < sphere.radius + 0.1) return false;
      }
    }
  }
  return true;
}

/// Some 15 blocked voxels where the robot's last bodies get, but for a few configurations, and as many
/// painted spheres.
inline Snapshot voxels_about(const Robot& robot, std::uint64_t seed, double edge = 0.05) {
  Random random(seed);
  FreeSpaceMap map({.resolution = edge});
  const int volume = map.add_volume("free", robot.critical_parts);
  std::vector<Configuration> homes;
  for (int i = 0; i < 4; ++i) homes.push_back(random.configuration(robot));
  for (int i = 0, blocked = 0; i < 400 && blocked < 15; ++i) {
    const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
    const Body& body = robot.bodies[robot.bodies.size() - 1 - static_cast<std::size_t>(random.below(2))];
    const Eigen::Vector3d at =
        poses[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation() + random.point(0.1);
    if (i < 15) map.paint(volume, {at, random.between(0.2, 0.5)});
    if (!keep_away(robot, homes, at)) continue;
    occupy(map, ((at / edge).array().floor() + 0.5) * edge);
    ++blocked;
  }
  return map.snapshot();
}

/// Where the way from a free configuration first leaves those that are free by shapes: all of the edge to
/// there is free (at the samples), but for its very end. None where it does not leave them.
inline std::optional<Configuration> just_inside(const CollisionModel& model, const Configuration& from,
                                                const Configuration& to) {
  const auto is_free = [&](double part) { return model.is_free_by_shapes(from + part * (to - from)); };
  if (!is_free(0.0)) return std::nullopt;
  double free = 0.0, blocked = 0.0;
  for (int i = 1; i <= 60 && blocked == 0.0; ++i) (is_free(i / 60.0) ? free : blocked) = i / 60.0;
  if (!(blocked > free)) return std::nullopt;
  while (blocked - free > 1e-7) {
    const double middle = (free + blocked) / 2;
    (is_free(middle) ? free : blocked) = middle;
  }
  return from + blocked * (to - from);
}

/// Pairs of configurations on both sides of where random ways leave or enter what is free by shapes: a
/// nanometre or so from contact.
inline std::vector<Configuration> on_borders(const CollisionModel& model, std::uint64_t seed,
                                             std::size_t count) {
  Random random(seed);
  std::vector<Configuration> sides;
  for (std::size_t i = 0; i < 20 * count && sides.size() < count; ++i) {
    const Configuration from = random.configuration(model.robot), to = random.configuration(model.robot);
    const auto is_free = [&](double part) { return model.is_free_by_shapes(from + part * (to - from)); };
    const bool begin = is_free(0.0);
    double same = 0.0, other = 0.0;
    for (int k = 1; k <= 12 && other == 0.0; ++k) (is_free(k / 12.0) == begin ? same : other) = k / 12.0;
    if (!(other > same)) continue;
    while (other - same > 1e-9) {
      const double middle = (same + other) / 2;
      (is_free(middle) == begin ? same : other) = middle;
    }
    sides.push_back(from + same * (to - from));
    sides.push_back(from + other * (to - from));
  }
  return sides;
}

}  // namespace clearway::worlds
