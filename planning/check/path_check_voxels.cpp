#include <algorithm>

#include "planning/check/path_check_model.hpp"

namespace clearway::check {

Eigen::AlignedBox3d bounds(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                           double margin) {
  const Eigen::Vector3d center = pose * bodies.box_center(body);
  const Eigen::Vector3d half = (pose.linear().cwiseAbs() * bodies.box_half(body)).array() + margin;
  return {center - half, center + half};
}

namespace {

/// A voxel of the shell, or a block of them, and how near it may be at the least.
struct Candidate {
  double bound;
  std::size_t index;
  bool is_block;
};

/// The nearest voxel of the shell that is nearer than `best`, or `best`. Best first: of blocks and voxels the
/// one that may be nearest is looked at next.
Nearest nearest_of_shell(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                         const BlockedCells& cells, Nearest best) {
  const Eigen::Matrix3d turn = pose.linear().transpose();
  const Eigen::Vector3d shift = -turn * pose.translation();
  const auto away = [&](const Eigen::Vector3d& point) {
    return bodies.point_distance(body, turn * point + shift);
  };
  const auto is_farther = [](const Candidate& a, const Candidate& b) { return a.bound > b.bound; };
  const double half_diagonal = 0.8660254037844387 * cells.edge() * (1.0 + 1e-9);
  std::vector<Candidate> near;
  cells.visit_blocks(bounds(bodies, body, pose, best.distance),
                     [&](const Eigen::Vector3d& middle, double reach, std::size_t block) {
                       const double bound = away(middle) - reach;
                       if (bound < best.distance) near.push_back({bound, block, true});
                     });
  std::make_heap(near.begin(), near.end(), is_farther);
  while (!near.empty()) {
    std::pop_heap(near.begin(), near.end(), is_farther);
    const Candidate next = near.back();
    near.pop_back();
    if (next.bound >= best.distance) break;
    if (next.is_block) {
      const auto [first, end] = cells.shell(next.index);
      for (std::size_t i = first; i < end; ++i) {
        const double bound = away(cells.shell_cell(i)) - half_diagonal;
        if (bound >= best.distance) continue;
        near.push_back({bound, i, false});
        std::push_heap(near.begin(), near.end(), is_farther);
      }
      continue;
    }
    const Eigen::Vector3d& center = cells.shell_cell(next.index);
    const double distance = bodies.cube_distance(body, pose, center, cells.edge(), best.distance);
    if (distance >= best.distance) continue;
    best = {distance, center};
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
