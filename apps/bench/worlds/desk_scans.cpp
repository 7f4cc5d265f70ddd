#include <array>
#include <cmath>

#include "apps/bench/worlds/room_scans.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/depth_renderer.hpp"
#include "datasets/simulation/surface.hpp"

namespace clearway::bench {
namespace {

Surface box(const Eigen::Vector3d& size, const Eigen::Vector3d& center, double turn = 0.0) {
  SceneShape shape{"", BoxShape{size}};
  shape.map_from_shape.translate(center).rotate(Eigen::AngleAxisd(0.17 + turn, Eigen::Vector3d::UnitZ()));
  return Surface(shape);
}

Surface cylinder(double radius, double length, const Eigen::Vector3d& center) {
  SceneShape shape{"", CylinderShape{radius, length}};
  shape.map_from_shape.translate(center);
  return Surface(shape);
}

/// The desk's top is at z = 0, its middle at x = y = 0; a wall stands behind it at x = 0.7.
std::vector<Surface> desk() {
  return {
      box({1.0, 2.4, 0.03}, {0, 0, -0.015}),          box({0.1, 6.0, 3.0}, {0.7, 0, 0.5}),
      box({6.0, 6.0, 0.1}, {-1.0, 0, -0.77}),         box({0.05, 0.52, 0.32}, {0.25, 0.1, 0.25}, 0.1),
      box({0.15, 0.2, 0.02}, {0.25, 0.1, 0.01}),      box({0.16, 0.44, 0.025}, {-0.15, 0.05, 0.0125}, 0.1),
      box({0.21, 0.3, 0.06}, {0.0, -0.5, 0.03}, 0.4), box({0.18, 0.24, 0.04}, {0.02, -0.5, 0.08}, -0.3),
      box({0.3, 0.3, 0.25}, {0.2, 0.75, 0.125}, 0.6), cylinder(0.04, 0.1, {-0.2, 0.5, 0.05}),
      cylinder(0.033, 0.24, {0.1, -0.85, 0.12})};
}

/// Half a circle over the desk's edge, the camera looking at the things on it.
Eigen::Isometry3d pose_round_desk(double share) {
  const double turn = 0.7 * std::sin(2.0 * M_PI * share);
  const Eigen::Vector3d eye(-1.0 * std::cos(turn), -1.1 * std::sin(turn),
                            0.75 + 0.1 * std::cos(4.0 * M_PI * share));
  const Eigen::Vector3d forward = (Eigen::Vector3d(0.1, 0, 0.05) - eye).normalized();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(forward).normalized();
  Eigen::Isometry3d pose(Eigen::Translation3d{eye});
  pose.linear() << forward, left, forward.cross(left);
  return pose;
}

}  // namespace

std::vector<Scan> desk_scans(std::size_t frames, std::size_t used) {
  const std::vector<Surface> surfaces = desk();
  SceneDepth camera;
  camera.intrinsics = {640, 480, 525.0, 525.0, 319.5, 239.5};
  camera.noise_constant = 0.0012;
  camera.noise_quadratic = 0.0019;
  camera.dropout = 0.11;
  for (std::size_t i = 0; i < frames; ++i)
    camera.map_from_sensor.push_back(pose_round_desk(static_cast<double>(i) / static_cast<double>(frames)));
  std::vector<Scan> scans(used);
  for (std::size_t i = 0; i < used; ++i) {
    DepthImage image = render_depth(camera, i, surfaces, 1);
    count_whole_steps(image);
    scans[i] = scan_of(image);
  }
  return scans;
}

}  // namespace clearway::bench
