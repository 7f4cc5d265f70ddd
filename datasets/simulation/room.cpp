#include "datasets/simulation/room.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/simulation/depth_renderer.hpp"
#include "datasets/sources/lens.hpp"

namespace clearway {
namespace {

SceneShape box(const char* name, const Eigen::Vector3d& size, const Eigen::Vector3d& center,
               double turn = 0.0) {
  SceneShape shape{name, BoxShape{size}};
  shape.map_from_shape.translate(center).rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  return shape;
}

SceneShape cylinder(const char* name, double radius, double length, const Eigen::Vector3d& center) {
  SceneShape shape{name, CylinderShape{radius, length}};
  shape.map_from_shape.translate(center);
  return shape;
}

SceneShape ball(const char* name, double radius, const Eigen::Vector3d& center) {
  SceneShape shape{name, SphereShape{radius}};
  shape.map_from_shape.translate(center);
  return shape;
}

/// The room turned a little against the voxels' axes, as real ones are.
std::vector<SceneShape> furnish() {
  std::vector<SceneShape> shapes{
      box("floor", {5.4, 4.4, 0.2}, {0, 0, -0.1}),
      box("ceiling", {5.4, 4.4, 0.2}, {0, 0, 2.7}),
      box("wall_front", {0.2, 4.4, 2.8}, {2.6, 0, 1.3}),
      box("wall_back", {0.2, 4.4, 2.8}, {-2.6, 0, 1.3}),
      box("wall_left", {5.4, 0.2, 2.8}, {0, 2.1, 1.3}),
      box("wall_right", {5.4, 0.2, 2.8}, {0, -2.1, 1.3}),
      box("table_top", {1.4, 0.8, 0.03}, {1.5, 0.6, 0.735}, 0.2),
      box("table_leg_1", {0.05, 0.05, 0.72}, {0.95, 0.2, 0.36}, 0.2),
      box("table_leg_2", {0.05, 0.05, 0.72}, {2.0, 0.95, 0.36}, 0.2),
      box("shelf_left", {0.3, 0.02, 1.8}, {2.3, -0.6, 0.9}),
      box("shelf_right", {0.3, 0.02, 1.8}, {2.3, -1.6, 0.9}),
      box("shelf_1", {0.3, 1.0, 0.02}, {2.3, -1.1, 0.4}),
      box("shelf_2", {0.3, 1.0, 0.02}, {2.3, -1.1, 0.85}),
      box("shelf_3", {0.3, 1.0, 0.02}, {2.3, -1.1, 1.3}),
      box("shelf_4", {0.3, 1.0, 0.02}, {2.3, -1.1, 1.75}),
      box("sofa", {0.8, 1.7, 0.45}, {-1.9, -0.6, 0.225}, -0.1),
      box("sofa_back", {0.2, 1.7, 0.9}, {-2.25, -0.55, 0.45}, -0.1),
      box("chair_seat", {0.42, 0.42, 0.04}, {0.7, 0.1, 0.45}, 0.7),
      box("chair_back", {0.04, 0.42, 0.45}, {0.55, -0.03, 0.7}, 0.7),
      box("box", {0.3, 0.25, 0.25}, {1.2, 0.7, 0.875}, 0.5),
      cylinder("column", 0.12, 2.6, {-0.9, 1.5, 1.3}),
      cylinder("bottle", 0.04, 0.3, {1.7, 0.4, 0.9}),
      cylinder("lamp_stick", 0.015, 1.5, {-1.9, 1.5, 0.75}),
      ball("lamp", 0.18, {-1.9, 1.5, 1.6}),
      ball("ball", 0.11, {0.3, -1.4, 0.11}),
  };
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(0.17, Eigen::Vector3d::UnitZ()));
  for (SceneShape& shape : shapes) shape.map_from_shape = turned * shape.map_from_shape;
  return shapes;
}

/// A slow round: the camera stands off the middle, looks outwards and down a little.
Eigen::Isometry3d pose_on_walk(double share) {
  const double turn = 2.0 * std::numbers::pi * share;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(-0.9 * std::cos(turn + 0.4), -0.7 * std::sin(turn + 0.4),
                                 1.35 + 0.15 * std::sin(3.0 * turn)));
  pose.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(0.25 + 0.12 * std::sin(2.0 * turn), Eigen::Vector3d::UnitY()));
  return pose;
}

}  // namespace

namespace {

/// Boards that lie aslant to every axis, and a ramp.
void add_slanted(std::vector<SceneShape>& shapes) {
  const auto tilted = [](const char* name, const Eigen::Vector3d& size, const Eigen::Vector3d& center,
                         double turn, double tilt) {
    SceneShape shape = box(name, size, center, turn);
    shape.map_from_shape.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()));
    return shape;
  };
  shapes.push_back(tilted("ramp", {0.8, 1.2, 0.03}, {-0.2, -1.3, 0.35}, 0.5, 0.5));
  shapes.push_back(tilted("easel", {0.7, 0.02, 1.0}, {-1.6, 0.9, 1.0}, 2.1, -0.35));
  shapes.push_back(tilted("roof", {1.2, 1.6, 0.04}, {1.7, -1.0, 2.2}, -0.4, 0.9));
}

/// On an oval, near the walls, now looking across the room and now along the wall, at changing heights.
Eigen::Isometry3d pose_on_wide_walk(double share) {
  const double turn = 2.0 * std::numbers::pi * share;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(
      Eigen::Vector3d(1.1 * std::cos(turn), 0.9 * std::sin(turn), 1.3 + 0.35 * std::sin(5.0 * turn)));
  const double across = turn + std::numbers::pi + 1.2 * std::sin(7.0 * turn);
  pose.rotate(Eigen::AngleAxisd(across, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(0.2 + 0.3 * std::sin(3.0 * turn), Eigen::Vector3d::UnitY()));
  return pose;
}

Scene room_scene(std::size_t frames, RoomWalk walk) {
  const bool is_wide = walk == RoomWalk::wide;
  Scene scene;
  scene.name = "furnished_room";
  scene.shapes = furnish();
  SceneDepth depth;
  if (is_wide) add_slanted(scene.shapes);
  depth.intrinsics = {640, 480, 525.0, 525.0, 319.5, 239.5};
  if (is_wide) depth.intrinsics = {320, 240, 262.5, 262.5, 159.5, 119.5};
  if (is_wide) depth.interval = 2.0;
  depth.max_range = 5.0;
  for (std::size_t i = 0; i < frames; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(frames);
    depth.map_from_sensor.push_back(is_wide ? pose_on_wide_walk(share) : pose_on_walk(share));
  }
  scene.depth = depth;
  return scene;
}

/// Signed distance from a point to the surface of a shape, negative inside. Exact.
double signed_distance(const SceneShape& shape, const Eigen::Vector3d& point) {
  const Eigen::Vector3d local = shape.map_from_shape.inverse() * point;
  if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) return local.norm() - sphere->radius;
  Eigen::Array3d beyond = Eigen::Array3d::Zero();  // of each pair of sides
  if (const auto* block = std::get_if<BoxShape>(&shape.geometry)) {
    beyond = local.array().abs() - 0.5 * block->size.array();
  } else {
    const auto& round = std::get<CylinderShape>(shape.geometry);
    beyond << local.head<2>().norm() - round.radius, std::abs(local.z()) - 0.5 * round.length, -HUGE_VAL;
  }
  return beyond.max(0.0).matrix().norm() + std::min(0.0, beyond.maxCoeff());
}

}  // namespace

FurnishedRoom::FurnishedRoom(std::size_t frames, std::uint64_t seed, double noise)
    : scene_(room_scene(frames, RoomWalk::round)), seed_(seed) {
  scene_.depth->noise_constant = 0.0012 * noise;
  scene_.depth->noise_quadratic = 0.0019 * noise;
  scene_.depth->dropout = noise > 0.0 ? 0.01 : 0.0;
  for (const SceneShape& shape : scene_.shapes) surfaces_.emplace_back(shape);
  state_poses();
}

FurnishedRoom::FurnishedRoom(std::size_t frames, std::uint64_t seed, const RoomErrors& errors, RoomWalk walk)
    : scene_(room_scene(frames, walk)), seed_(seed) {
  scene_.depth->noise = errors.depth;
  scene_.depth->errors = errors.sequence;
  for (const SceneShape& shape : scene_.shapes) surfaces_.emplace_back(shape);
  state_poses();
}

void FurnishedRoom::state_poses() {
  deliveries_ = deliver_depth(camera(), seed_);
  SceneDepth all = camera();
  all.errors.dropped = all.errors.repeated = 0.0;
  for (const Delivery& delivery : deliver_depth(all, seed_)) stated_.push_back(delivery.map_from_sensor);
}

CloudFrame FurnishedRoom::frame(std::size_t index) const {
  const DepthImage image = photograph_depth(camera(), index, surfaces_, seed_);
  CloudFrame cloud;
  cloud.kind = "depth";
  cloud.max_range = camera().max_range;
  cloud.world_from_sensor = stated_pose(index);
  const CameraIntrinsics& intrinsics = image.intrinsics;
  const Lens lens(intrinsics);
  for (int row = 0; row < intrinsics.height; ++row) {
    for (int column = 0; column < intrinsics.width; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(intrinsics.width) +
                                static_cast<std::size_t>(column);
      const float range = image.ranges[pixel];
      if (!(range > 0.0F)) continue;
      const auto optical = lens.pixel_ray({static_cast<double>(column), static_cast<double>(row)});
      if (!optical) continue;
      const Eigen::Vector3d ray = Eigen::Vector3d(1, -optical->x(), -optical->y()).normalized();
      cloud.points.push_back((static_cast<double>(range) * ray).cast<float>());
    }
  }
  return cloud;
}

Hit FurnishedRoom::truth(std::size_t index, const Eigen::Vector3d& direction) const {
  const Eigen::Isometry3d& pose = camera().map_from_sensor[index];
  std::vector<const Surface*> all;
  for (const Surface& surface : surfaces_) all.push_back(&surface);
  return cast_ray(all, pose.translation(), pose.linear() * direction).hit;
}

double FurnishedRoom::distance_to_solid(const Eigen::Vector3d& point) const {
  double nearest = HUGE_VAL;
  for (const SceneShape& shape : scene_.shapes) nearest = std::min(nearest, signed_distance(shape, point));
  return nearest;
}

bool FurnishedRoom::is_solid(const Eigen::Vector3d& point) const { return distance_to_solid(point) <= 0.0; }

}  // namespace clearway
