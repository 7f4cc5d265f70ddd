#include "apps/bench/worlds/live_room.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "apps/bench/worlds/arm_worlds.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "apps/suites/suite_scans.hpp"
#include "datasets/simulation/depth_renderer.hpp"
#include "datasets/simulation/surface.hpp"
#include "datasets/sources/lens.hpp"

namespace clearway::bench {
namespace {

constexpr double half = 1.2, room_height = 2.4, thickness = 0.1;
constexpr std::size_t frames_a_place = 10, frames_with_fist = 3;

SceneShape box_at(const Eigen::Vector3d& size, const Eigen::Vector3d& center) {
  SceneShape shape{"", BoxShape{size}};
  shape.map_from_shape.translation() = center;
  return shape;
}

SceneShape ball(const Sphere& sphere) {
  SceneShape shape{"", SphereShape{sphere.radius}};
  shape.map_from_shape.translation() = sphere.center;
  return shape;
}

/// Floor, ceiling and walls; their faces a third of a voxel off the grid.
std::vector<SceneShape> walls(double resolution) {
  std::vector<SceneShape> all;
  const Eigen::Vector3d middle(0.0, 0.0, room_height / 2 - 0.2);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Eigen::Vector3d size = Eigen::Vector3d::Constant(2 * half + 2 * thickness), at = middle;
      size[axis] = thickness;
      at[axis] += side * (half + thickness / 2) + resolution / 3;
      all.push_back(box_at(size, at));
    }
  }
  return all;
}

}  // namespace

LiveRoom::LiveRoom(double resolution)
    : resolution_(resolution), eye_(-1.05, -1.0, 1.7), things_(walls(resolution)) {
  Dice dice(5);
  for (int hanging = 0; hanging < 24;) {
    const Sphere at{dice.point({Eigen::Vector3d(-half, -half, 0.0), Eigen::Vector3d(half, half, 2.0)}),
                    dice.between(0.03, 0.15)};
    if (at.center.head<2>().norm() < 0.45 || (at.center - eye_).norm() < 0.5) continue;
    things_.push_back(ball(at));
    ++hanging;
  }
  camera_.intrinsics = {640, 480, 525.0, 525.0, 319.5, 239.5};
  camera_.noise_constant = 0.0012;
  camera_.noise_quadratic = 0.0019;
  camera_.dropout = 0.11;
  const Eigen::Vector3d forward = (Eigen::Vector3d(0.0, 0.0, 0.6) - eye_).normalized();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(forward).normalized();
  Eigen::Isometry3d pose(Eigen::Translation3d{eye_});
  pose.linear() << forward, left, forward.cross(left);
  camera_.map_from_sensor = {pose};
}

std::vector<Scan> LiveRoom::views() const {
  std::vector<Scan> scans;
  for (const Eigen::Vector3d& from : {eye_, Eigen::Vector3d(1.0, 1.05, 1.8), Eigen::Vector3d(0.1, 0.2, 1.9),
                                      Eigen::Vector3d(1.0, -1.0, 0.3), Eigen::Vector3d(-1.0, 1.0, 0.4)})
    scans.push_back(scan_solids(things_, from, 4.0 * half, resolution_));
  return scans;
}

bool LiveRoom::is_seen(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d in_sensor = camera_.map_from_sensor.front().inverse() * point;
  if (in_sensor.x() <= 0.1) return false;
  const auto pixel = Lens(camera_.intrinsics).project({-in_sensor.y(), -in_sensor.z(), in_sensor.x()});
  if (!pixel || pixel->x() < 30.0 || pixel->x() > 610.0 || pixel->y() < 30.0 || pixel->y() > 450.0)
    return false;
  const std::vector<Surface> surfaces(things_.begin(), things_.end());
  std::vector<const Surface*> targets;
  for (const Surface& surface : surfaces) targets.push_back(&surface);
  return cast_ray(targets, eye_, point - eye_).hit.along > 1.0;
}

std::vector<LiveFrame> LiveRoom::frames(const std::vector<Sphere>& places) const {
  const std::size_t count = frames_a_place * places.size();
  SceneDepth camera = camera_;
  camera.map_from_sensor.assign(count, camera_.map_from_sensor.front());
  std::vector<LiveFrame> frames(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    std::vector<Surface> surfaces(things_.begin(), things_.end());
    surfaces.emplace_back(ball({{0.95 * std::cos(turn), 0.95 * std::sin(turn), 1.3}, 0.08}));
    if (i % frames_a_place < frames_with_fist) {
      frames[i].place = static_cast<int>(i / frames_a_place);
      surfaces.emplace_back(ball(places[i / frames_a_place]));
    }
    DepthImage image = render_depth(camera, i, surfaces, 1);
    count_whole_steps(image);
    frames[i].scan = scan_of(image);
  }
  return frames;
}

}  // namespace clearway::bench
