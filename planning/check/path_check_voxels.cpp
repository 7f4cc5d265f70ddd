#include <algorithm>

#include "planning/check/path_check_model.hpp"

namespace clearway::check {

Eigen::AlignedBox3d bounds(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                           double margin) {
  const PointDistance& box = bodies.point_distance(body);
  const Eigen::Vector3d center = pose * box.box_center;
  const Eigen::Vector3d half = (pose.linear().cwiseAbs() * box.box_half).array() + margin;
  return {center - half, center + half};
}

namespace {

/// A voxel of the shell, or a block of them, and how near it may be at the least.
struct Candidate {
  double bound;
  bool is_block;
  Eigen::Vector3i block;
  Eigen::Vector3d voxel;
};

/// The nearest voxel of the shell that is nearer than `best`, or `best`. Best first: of blocks and voxels the
/// one that may be nearest is looked at next.
Nearest nearest_of_shell(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                         const BlockedCells& cells, Nearest best) {
  const Eigen::Matrix3d turn = pose.linear().transpose();
  const Eigen::Vector3d shift = -turn * pose.translation();
  const PointDistance distance_to = bodies.point_distance(body);
  const auto away = [&](const Eigen::Vector3d& point) { return distance_to(turn * point + shift); };
  const auto is_farther = [](const Candidate& a, const Candidate& b) { return a.bound > b.bound; };
  const double half_diagonal = 0.8660254037844387 * cells.edge() * (1.0 + 1e-9);
  std::vector<Candidate> near;
  cells.visit_blocks(bounds(bodies, body, pose, best.distance),
                     [&](const Eigen::Vector3d& middle, double reach, const Eigen::Vector3i& block) {
                       const double bound = away(middle) - reach;
                       if (bound < best.distance)
                         near.push_back({bound, true, block, Eigen::Vector3d::Zero()});
                     });
  std::make_heap(near.begin(), near.end(), is_farther);
  while (!near.empty()) {
    std::pop_heap(near.begin(), near.end(), is_farther);
    const Candidate next = near.back();
    near.pop_back();
    if (next.bound >= best.distance) break;
    if (next.is_block) {
      cells.visit_shell(next.block, [&](const Eigen::Vector3d& voxel) {
        const double bound = away(voxel) - half_diagonal;
        if (bound >= best.distance) return;
        near.push_back({bound, false, Eigen::Vector3i::Zero(), voxel});
        std::push_heap(near.begin(), near.end(), is_farther);
      });
      continue;
    }
    const double distance = bodies.cube_distance(body, pose, next.voxel, cells.edge(), best.distance);
    if (distance >= best.distance) continue;
    best = {distance, next.voxel};
    if (distance <= 0.0) break;
  }
  return best;
}

}  // namespace

Nearest nearest_voxel(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                      const Eigen::Vector3d& inside, const BlockedCells& cells, double limit,
                      const std::optional<Eigen::Vector3d>& hint) {
  if (const Eigen::Vector3i cell = cells.cell(inside); cells.is_blocked(cell))
    return {0.0, cells.center(cell)};
  if (hint) {
    const double distance = bodies.cube_distance(body, pose, *hint, cells.edge(), limit);
    if (distance < limit) return nearest_of_shell(bodies, body, pose, cells, {distance, hint});
  }
  for (double radius = std::min(3.0 * cells.edge(), limit);; radius = std::min(3.0 * radius, limit)) {
    const Nearest found =
        nearest_of_shell(bodies, body, pose, cells, {radius, {}});  // near voxels first: there are few
    if (found.cube || radius >= limit) return found;
  }
}

}  // namespace clearway::check
