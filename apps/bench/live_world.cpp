#include "apps/bench/live_world.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t place_count = 5;
constexpr double fist = 0.04;  ///< radius, m

/// From a point to the nearest body that moves.
double gap_to_arm(const ConfigurationSpace& space, const Configuration& q, const Eigen::Vector3d& point) {
  const Robot& robot = space.robot();
  const LinkPoses poses = forward_kinematics(robot, q);
  double least = 1e9;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    if (space.blocked_space(static_cast<int>(i)) == nullptr) continue;
    const Body& body = robot.bodies[i];
    const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    least = std::min(least, body.shape.signed_distance(pose.inverse() * point));
  }
  return least;
}

std::vector<Sphere> places_about(const LoopTask& task, const LiveRoom& room, const ConfigurationSpace& space,
                                 double influence, Dice& dice) {
  std::vector<Sphere> places;
  const Eigen::Vector3d tip = tip_pose(space.robot(), task.one).translation();
  const Eigen::AlignedBox3d cube(Eigen::Vector3d::Constant(-0.2), Eigen::Vector3d::Constant(0.2));
  for (int trial = 0; trial < 4000 && places.size() < place_count; ++trial) {
    const Eigen::Vector3d at = dice.between(0.2, 1.1) * tip + dice.point(cube);
    const Eigen::Vector3d front = at + fist * (room.camera() - at).normalized();
    if (space.blocked_space(2)->clearance(at) < 3.0 * fist || !room.is_seen(at)) continue;
    const bool is_apart = std::all_of(places.begin(), places.end(),
                                      [&](const Sphere& other) { return (other.center - at).norm() > 0.2; });
    const auto is_beside = [&](const Configuration& q) {
      const double gap = gap_to_arm(space, q, front);
      return gap > 0.03 && gap < influence - 0.025 && gap_to_arm(space, q, at) > fist + 0.02;
    };
    if (is_apart && is_beside(task.one) && is_beside(task.other)) places.push_back({at, fist});
  }
  return places;
}

}  // namespace

LiveWorld make_live_world(double resolution, double influence) {
  const LiveRoom room(resolution);
  // With OctoMap's 0.7 a voxel that was seen free for long is occupied after its third hit; so the first
  // counts.
  LiveWorld world{
      load_robot("puma560"),
      FreeSpaceMap({.resolution = resolution, .hit_probability = 0.9, .discretize = true, .threads = 2}),
      {},
      {}};
  for (const Scan& scan : room.views()) world.map.insert(scan);
  world.task.resolution = resolution;
  const ConfigurationSpace space = world.space(world.map.snapshot());
  Dice dice(2);
  for (int trial = 0; trial < 2000; ++trial) {
    world.task.one = dice.configuration(world.robot);
    world.task.other = world.task.one + 0.01 * Eigen::VectorXd::Ones(6);
    if (!space.is_free(world.task.one) || !space.is_free(world.task.other)) continue;
    const double clearance = space.clearance(world.task.one);
    if (clearance > 0.75 * influence || clearance < 0.25 * influence) continue;
    world.task.places = places_about(world.task, room, space, influence, dice);
    if (world.task.places.size() < place_count) continue;
    world.frames = room.frames(world.task.places);
    return world;
  }
  throw std::runtime_error("live: found no place for the arm");
}

}  // namespace clearway::bench
