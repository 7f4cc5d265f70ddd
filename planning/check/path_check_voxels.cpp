#include <algorithm>
#include <utility>

#include "planning/check/path_check_model.hpp"

namespace clearway::check {

Eigen::AlignedBox3d bounds(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                           double margin) {
  const Eigen::Vector3d center = pose * bodies.box_center(body);
  const Eigen::Vector3d half = (pose.linear().cwiseAbs() * bodies.box_half(body)).array() + margin;
  return {center - half, center + half};
}

namespace {

/// The nearest voxel of the shell no farther than `limit`.
Nearest nearest_of_shell(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                         const BlockedCells& cells, double limit) {
  const double half_diagonal = 0.8660254037844387 * cells.edge() * (1.0 + 1e-9);
  const Eigen::Isometry3d body_from_map = pose.inverse();
  std::vector<std::pair<double, Eigen::Vector3d>>
      near;  // with a quick lower bound: to the box around the body
  for (const Eigen::Vector3i& cell : cells.shell(bounds(bodies, body, pose, limit))) {
    const Eigen::Vector3d center = cells.center(cell);
    const Eigen::Vector3d local = body_from_map * center - bodies.box_center(body);
    const double bound = (local.cwiseAbs() - bodies.box_half(body)).cwiseMax(0.0).norm() - half_diagonal;
    if (bound < limit) near.emplace_back(bound, center);
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Nearest best{limit, {}};
  for (const auto& [bound, center] : near) {
    if (bound >= best.distance) break;
    const double distance = bodies.cube_distance(body, pose, center, cells.edge());
    if (distance >= best.distance) continue;
    best = {distance, center};
    if (distance <= 0.0) break;
  }
  return best;
}

}  // namespace

Nearest nearest_voxel(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                      const Eigen::Vector3d& inside, const BlockedCells& cells, double limit) {
  if (const Eigen::Vector3i cell = cells.cell(inside); cells.is_blocked(cell))
    return {0.0, cells.center(cell)};
  for (double radius = std::min(3.0 * cells.edge(), limit);; radius = std::min(3.0 * radius, limit)) {
    const Nearest found =
        nearest_of_shell(bodies, body, pose, cells, radius);  // near voxels first: there are few
    if (found.cube || radius >= limit) return found;
  }
}

}  // namespace clearway::check
