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

/// A voxel, and how near it may be at the least.
struct Candidate {
  double bound;
  Eigen::Vector3d center;
};

/// The voxels of the shell that may be nearer than `limit`: by how far their centres are from the body.
std::vector<Candidate> shell_near(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                                  const BlockedCells& cells, double limit) {
  const Eigen::Matrix3d turn = pose.linear().transpose();
  const Eigen::Vector3d shift = -turn * pose.translation();
  const auto away = [&](const Eigen::Vector3d& point) {
    return bodies.point_distance(body, turn * point + shift);
  };
  const double half_diagonal = 0.8660254037844387 * cells.edge() * (1.0 + 1e-9);
  std::vector<Candidate> near;
  cells.visit_shell(
      bounds(bodies, body, pose, limit),
      [&](const Eigen::Vector3d& middle, double reach) { return away(middle) - reach < limit; },
      [&](const Eigen::Vector3d& center) {
        const double bound = away(center) - half_diagonal;
        if (bound < limit) near.push_back({bound, center});
      });
  return near;
}

/// The nearest voxel of the shell that is nearer than `best`, or `best`.
Nearest nearest_of_shell(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                         const BlockedCells& cells, Nearest best) {
  std::vector<Candidate> near = shell_near(bodies, body, pose, cells, best.distance);
  const auto is_farther = [](const Candidate& a, const Candidate& b) { return a.bound > b.bound; };
  std::make_heap(near.begin(), near.end(), is_farther);
  for (auto end = near.end(); end != near.begin();) {  // few are looked at, so they are not sorted
    std::pop_heap(near.begin(), end, is_farther);
    const Candidate& candidate = *--end;
    if (candidate.bound >= best.distance) break;
    const double distance = bodies.cube_distance(body, pose, candidate.center, cells.edge(), best.distance);
    if (distance >= best.distance) continue;
    best = {distance, candidate.center};
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
