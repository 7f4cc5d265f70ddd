#include "apps/overlay/overlay_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

namespace clearway {
namespace {

// Okabe and Ito 2008: distinct with any kind of colour vision.
constexpr Colour orange{230, 159, 0}, sky_blue{86, 180, 233}, bluish_green{0, 178, 130}, yellow{240, 228, 66},
    blue{0, 114, 178}, vermilion{213, 94, 0}, purple{204, 121, 167}, dark{25, 25, 25}, pale{232, 232, 228},
    conflict_red{220, 20, 30};
constexpr std::array<Colour, 4> volume_colours{bluish_green, purple, yellow, blue};

Mesh faces_of(const PageVoxels& voxels) { return mesh_of(exposed_faces(voxels), voxels.size); }

void add_robot(Canvas& canvas, const RobotSurface& robot, const LinkPoses& poses, Colour body,
               Colour critical, int layer) {
  for (const RobotSurface::Part& part : robot.parts)
    canvas.add(part.mesh, poses.at(static_cast<std::size_t>(part.link)),
               {part.is_critical ? critical : body, layer == 0 ? 0.42 : 0.6}, layer);
}

void add_ghost(Canvas& canvas, const OverlayScene& scene, const LinkPoses& poses, Colour colour) {
  if (scene.robot == nullptr || poses.empty()) return;
  add_robot(canvas, *scene.robot, poses, colour, colour, canvas.add_layer(0.5));
}

void add_loads(Canvas& canvas, const OverlayScene& scene, OverlayLoad::Holder holder, Colour colour,
               int layer) {
  for (const OverlayLoad& load : scene.loads)
    if (load.holder == holder)
      canvas.add(load.mesh, load.map_from_load,
                 {load.is_refused ? conflict_red : colour, layer == 0 ? 0.5 : 0.6}, layer);
}

/// In layers of their own, blended over the ghosts that hold them.
void add_clear_loads(Canvas& canvas, const OverlayScene& scene) {
  using Holder = OverlayLoad::Holder;
  for (const auto& [holder, colour] :
       {std::pair(Holder::start, sky_blue), std::pair(Holder::goal, yellow), std::pair(Holder::none, purple)})
    add_loads(canvas, scene, holder, colour, canvas.add_layer(0.7));
}

double most_clearance(const OverlayPath& path) {
  double most = 0.0;
  for (const double clearance : path.clearance)
    if (std::isfinite(clearance)) most = std::max(most, clearance);
  return most;
}

/// A dark edge, and over it pieces in the colours of their ends' mean; paint would change these.
void add_path(Canvas& canvas, const OverlayPath& path, double width) {
  if (path.points.size() < 2) return;
  const double most = most_clearance(path);
  canvas.add_line(path.points, width + 2.5, dark, canvas.add_layer(1.0, true));
  const int layer = canvas.add_layer(1.0, true);
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const double clearance = 0.5 * (path.clearance[i] + path.clearance[i + 1]);
    canvas.add_line({path.points[i], path.points[i + 1]}, width,
                    std::isfinite(clearance) ? clearance_colour(clearance, most) : pale, layer);
  }
}

/// Each with a dark edge, which lies a thousandth farther off.
void add_dots(Canvas& canvas, const OverlayScene& scene, double radius) {
  const Eigen::Vector3d eye = canvas.camera_from_map().inverse().translation();
  for (const Eigen::Vector3d& center : scene.dots) {
    canvas.add_point(center + 1e-3 * (center - eye), radius + 1.0, dark);
    canvas.add_point(center, radius, scene.is_outside ? conflict_red : bluish_green);
  }
}

void add_map(Canvas& canvas, const OverlayMap& map, bool shows_volumes) {
  canvas.add_occluder(map.occupied);
  if (!map.conflicts.triangles.empty())  // seen through paint that is nearer, too
    canvas.add(map.conflicts, Eigen::Isometry3d::Identity(), {conflict_red, 0.7},
               canvas.add_layer(0.85, true));
  if (!shows_volumes) return;
  const int layer = canvas.add_layer(0.38);
  for (std::size_t i = 0; i < map.volumes.size(); ++i)
    canvas.add(map.volumes[i].faces, Eigen::Isometry3d::Identity(),
               {volume_colours[i % volume_colours.size()], 0.78}, layer);
}

void add_ball(Canvas& canvas, const OverlayBall& ball) {
  const Colour colour = ball.is_accepted ? sky_blue : vermilion;
  canvas.add_disc(ball.center, ball.radius + ball.bound, colour, canvas.add_layer(0.45));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = ball.center;
  canvas.add(mesh_of(Shape::sphere(ball.radius)), pose, {colour, 0.35}, canvas.add_layer(0.6));
}

void add_advice(Canvas& canvas, const std::vector<Sphere>& spheres) {
  if (spheres.empty()) return;
  const int layer = canvas.add_layer(0.5);
  for (const Sphere& sphere : spheres) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = sphere.center;
    canvas.add(mesh_of(Shape::sphere(sphere.radius)), pose, {yellow, 0.35}, layer);
  }
}

/// Beside the point, where the picture has room for it.
void write_at(cv::Mat& picture, const Canvas& canvas, const std::optional<Eigen::Vector3d>& point,
              const std::string& text, Colour colour) {
  if (!point) return;
  const auto pixel = canvas.projector().pixel(canvas.camera_from_map() * *point);
  if (!pixel || !canvas.projector().camera().sees(*pixel)) return;
  const double scale = 1.1 * text_scale(picture.rows);
  const int aside = static_cast<int>(14 * scale),
            width = static_cast<int>(20 * scale * static_cast<double>(text.size()));
  int x = static_cast<int>(pixel->x()) + aside;
  if (x + width > picture.cols) x = static_cast<int>(pixel->x()) - aside - width;
  draw_text(picture, text, x, static_cast<int>(pixel->y()) - aside, scale, colour);
}

}  // namespace

Colour clearance_colour(double clearance, double most) {
  const double share = most > 0.0 ? std::clamp(clearance / most, 0.0, 1.0) : 0.0;
  const Colour white{245, 245, 245};
  const auto mixed = [](Colour a, Colour b, double t) {
    const auto mix = [t](std::uint8_t from, std::uint8_t to) {
      return static_cast<std::uint8_t>(std::lround(from + t * (to - from)));
    };
    return Colour{mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
  };
  return share < 0.5 ? mixed(vermilion, white, 2.0 * share) : mixed(white, blue, 2.0 * share - 1.0);
}

OverlayMap overlay_map(const Snapshot& map) {
  PageVoxels occupied{"occupied", map.resolution()}, conflicts{"conflict", map.resolution()};
  std::vector<PageVoxels> painted(std::max<std::size_t>(map.volumes().size(), 1),
                                  PageVoxels{"painted", map.resolution()});
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state == VoxelState::occupied) occupied.add(leaf.center, leaf.size);
    if (leaf.state == VoxelState::conflict) conflicts.add(leaf.center, leaf.size);
    if (leaf.state != VoxelState::painted) return;
    for (std::size_t i = 0; i < painted.size(); ++i)
      if ((leaf.volumes >> i & 1U) != 0) painted[i].add(leaf.center, leaf.size);
  });
  OverlayMap shown{{}, faces_of(conflicts), faces_of(occupied)};
  for (std::size_t i = 0; i < painted.size(); ++i)
    shown.volumes.push_back(
        {i < map.volumes().size() ? map.volumes()[i].label : "painted", faces_of(painted[i])});
  return shown;
}

RobotSurface::RobotSurface(const Robot& robot) {
  for (const Body& body : robot.bodies) {
    const bool is_critical = std::find(robot.critical_parts.begin(), robot.critical_parts.end(), body.part) !=
                             robot.critical_parts.end();
    parts.push_back({body.link, is_critical, transformed(mesh_of(body.shape), body.link_from_shape)});
  }
}

cv::Mat draw_overlay(const cv::Mat& image, const Camera& camera, const Eigen::Isometry3d& camera_from_map,
                     const OverlayScene& scene, std::size_t threads) {
  Canvas canvas(camera, camera_from_map);
  if (scene.map != nullptr) add_map(canvas, *scene.map, scene.dots.empty());
  add_dots(canvas, scene, std::max(1.5, camera.height / 300.0));
  add_ghost(canvas, scene, scene.start_pose, sky_blue);
  add_ghost(canvas, scene, scene.goal_pose, yellow);
  if (scene.robot != nullptr && !scene.robot_pose.empty())
    add_robot(canvas, *scene.robot, scene.robot_pose, pale, orange, 0);
  if (!scene.loads.empty()) {
    add_clear_loads(canvas, scene);
    add_loads(canvas, scene, OverlayLoad::Holder::hand, purple, 0);
  }
  add_path(canvas, scene.path, std::max(2.5, camera.height / 144.0));
  add_advice(canvas, scene.to_paint);
  if (scene.ball) add_ball(canvas, *scene.ball);
  cv::Mat picture = canvas.draw(image, threads);
  write_at(picture, canvas, scene.start_tip, "start", sky_blue);
  write_at(picture, canvas, scene.goal_tip, "goal", yellow);
  if (scene.strip) {
    Strip strip = *scene.strip;
    if (strip.clearance_m == 0.0) strip.clearance_m = most_clearance(scene.path);
    draw_strip(picture, strip);
  }
  return picture;
}

}  // namespace clearway
