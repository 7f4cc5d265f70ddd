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
  const double length = probe.ball_center.norm();
  if (length > 1e-6) {
    SceneShape stick{"stick", CylinderShape{std::min(0.1 * probe.ball_radius, 0.01), length}, map_from_probe,
                     90};
    stick.map_from_shape.translate(0.5 * probe.ball_center);
    stick.map_from_shape.rotate(
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), probe.ball_center));
    surfaces.emplace_back(stick);
  }
  return surfaces;
}

}  // namespace clearway
