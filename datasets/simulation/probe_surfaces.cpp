#include "datasets/simulation/probe_surfaces.hpp"

#include <algorithm>

#include "datasets/simulation/tag_pattern.hpp"

namespace clearway {
namespace {

void add_tags(const BoardSetup& board, const Eigen::Isometry3d& map_from_board,
              std::vector<Surface>& surfaces) {
  for (const auto& tag : board.tags)
    surfaces.emplace_back(TagShape{tag.size, tag36h11_cells(tag.id)}, map_from_board * tag.board_from_tag);
}

/// From the origin of a board to a point of its frame.
void add_stick(const Eigen::Isometry3d& map_from_board, const Eigen::Vector3d& end, double radius,
               std::vector<Surface>& surfaces) {
  const double length = end.norm();
  if (length <= 1e-6) return;
  SceneShape stick{"stick", CylinderShape{radius, length}, map_from_board, 90};
  stick.map_from_shape.translate(0.5 * end);
  const Eigen::Vector3d axis =
      (end.z() < 0.0 ? -1.0 : 1.0) / length * end;  // which way it points does not show
  stick.map_from_shape.rotate(Eigen::Quaterniond(1.0 + axis.z(), -axis.y(), axis.x(), 0.0).normalized());
  surfaces.emplace_back(stick);
}

void add_capsule(const Eigen::Isometry3d& map_from_board, const CapsuleSetup& capsule, double grey,
                 std::vector<Surface>& surfaces) {
  const Eigen::Vector3d way = capsule.to - capsule.from;
  for (const Eigen::Vector3d& end : {capsule.from, capsule.to}) {
    SceneShape cap{"hand", SphereShape{capsule.radius}, map_from_board, grey};
    cap.map_from_shape.translate(end);
    surfaces.emplace_back(cap);
  }
  if (way.norm() <= 1e-6) return;
  SceneShape side{"hand", CylinderShape{capsule.radius, way.norm()}, map_from_board, grey};
  side.map_from_shape.translate(0.5 * (capsule.from + capsule.to));
  const Eigen::Vector3d along = way.normalized(), across = along.unitOrthogonal();
  Eigen::Matrix3d turn;
  turn << across, along.cross(across), along;
  side.map_from_shape.rotate(turn);
  surfaces.emplace_back(side);
}

/// A finger over the middle of a tag, across its bits.
void add_finger(const Eigen::Isometry3d& map_from_board, const TagSetup& tag, double grey,
                std::vector<Surface>& surfaces) {
  const double radius = 0.3 * tag.size;
  const CapsuleSetup finger{{-0.4 * tag.size, 0, radius}, {0.4 * tag.size, 0, radius}, radius};
  add_capsule(map_from_board * tag.board_from_tag, finger, grey, surfaces);
}

}  // namespace

std::vector<Surface> still_surfaces(const Scene& scene) {
  std::vector<Surface> surfaces(scene.shapes.begin(), scene.shapes.end());
  for (const auto& board : scene.setup.boards)
    if (board.map_from_board) add_tags(board, *board.map_from_board, surfaces);
  return surfaces;
}

std::vector<Surface> probe_surfaces(const Setup& setup, const Eigen::Isometry3d& map_from_probe) {
  const ProbeSetup& probe = *setup.probe;
  std::vector<Surface> surfaces;
  add_tags(*setup.board(probe.board), map_from_probe, surfaces);
  SceneShape ball{"ball", SphereShape{probe.ball_radius}, map_from_probe, 150};
  ball.map_from_shape.translate(probe.ball_center);
  surfaces.emplace_back(ball);
  add_stick(map_from_probe, probe.ball_center, std::min(0.1 * probe.ball_radius, 0.01), surfaces);
  return surfaces;
}

MovingThings moving_things(const Scene& scene, const ProbeMotion& motion, double time) {
  MovingThings moving;
  const bool is_in_sight = time >= motion.begin() && time <= motion.duration();
  if (!scene.gripper || is_in_sight) moving.probe = motion.at(time);
  if (scene.gripper) moving.map_from_tip = scene.gripper->at(time);
  if (!scene.hands || !moving.probe) return moving;
  for (const SceneHands::Cover& cover : scene.hands->covers)
    if (time >= cover.from && time < cover.to) moving.covered.push_back(cover.tag);
  return moving;
}

namespace {

void add_probe_hand(const Scene& scene, const MovingThings& moving, std::vector<Surface>& surfaces) {
  const Eigen::Isometry3d& map_from_probe = moving.probe->map_from_probe;
  for (const CapsuleSetup& capsule : scene.hands->probe)
    add_capsule(map_from_probe, capsule, scene.hands->grey, surfaces);
  for (const TagSetup& tag : scene.setup.board(scene.setup.probe->board)->tags)
    if (std::find(moving.covered.begin(), moving.covered.end(), tag.id) != moving.covered.end())
      add_finger(map_from_probe, tag, scene.hands->grey, surfaces);
}

}  // namespace

std::vector<Surface> surfaces_of(const Scene& scene, const MovingThings& moving) {
  std::vector<Surface> surfaces;
  if (moving.probe) surfaces = probe_surfaces(scene.setup, moving.probe->map_from_probe);
  if (moving.probe && scene.hands) add_probe_hand(scene, moving, surfaces);
  if (!moving.map_from_tip) return surfaces;
  const GripperSetup& gripper = *scene.setup.gripper;
  const BoardSetup& board = *scene.setup.board(gripper.board);
  const Eigen::Isometry3d map_from_board = *moving.map_from_tip * gripper.board_from_tip.inverse();
  add_tags(board, map_from_board, surfaces);
  const Eigen::Vector3d tip = gripper.board_from_tip.translation();
  add_stick(map_from_board, tip, 0.02 * tip.norm(), surfaces);
  if (scene.hands)
    for (const CapsuleSetup& capsule : scene.hands->gripper)
      add_capsule(map_from_board, capsule, scene.hands->grey, surfaces);
  return surfaces;
}

}  // namespace clearway
