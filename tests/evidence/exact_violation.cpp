#include "tests/evidence/exact_violation.hpp"

#include <cmath>

#include "tests/worlds/fcl_truth.hpp"

namespace clearway::evidence {
namespace {

bool is_moved(const Robot& robot, const Body& body) {
  for (int link = body.link; link >= 0; link = robot.links[static_cast<std::size_t>(link)].parent)
    if (robot.links[static_cast<std::size_t>(link)].joint >= 0) return true;
  return false;
}

/// Volumes that a part may lie in: those that name it, or all when none does.
unsigned volumes_for(const Snapshot& map, const std::string& part) {
  unsigned mask = 0;
  for (std::size_t i = 0; i < map.volumes().size(); ++i) {
    const auto& parts = map.volumes()[i].critical_parts;
    if (std::find(parts.begin(), parts.end(), part) != parts.end()) mask |= 1U << i;
  }
  return mask == 0 ? ~0U : mask;
}

bool is_forbidden(const Voxel& voxel, Policy policy, unsigned volumes) {
  switch (voxel.state) {
    case VoxelState::occupied:
    case VoxelState::conflict:
      return true;
    case VoxelState::unknown:
      return policy != Policy::not_occupied;
    case VoxelState::seen_free:
      return policy == Policy::painted;
    case VoxelState::painted:
      return policy == Policy::painted && (voxel.volumes & volumes) == 0;
  }
  return true;
}

struct BodyPoints {
  const Body* body;
  Policy policy;
  unsigned volumes;
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
};

bool is_inside_something(const BodyPoints& probe, const Eigen::Isometry3d& pose, const Snapshot& map,
                         double depth) {
  const double edge = map.resolution(), inner = edge - 2.0 * depth;
  const fcl::Boxd cube(inner, inner, inner);
  const Eigen::AlignedBox3d bounds = probe.body->shape.bounds(pose);
  const Eigen::Array3i low = (bounds.min() / edge).array().floor().cast<int>(),
                       high = (bounds.max() / edge).array().floor().cast<int>();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const Eigen::Vector3d middle = (Eigen::Array3d(x, y, z) + 0.5) * edge;
        if (!is_forbidden(map.voxel(middle), probe.policy, probe.volumes)) continue;
        const Eigen::Isometry3d at(Eigen::Translation3d{middle});
        if (fcl_collide(probe.geometry.get(), pose, &cube, at)) return true;
      }
    }
  }
  return false;
}

}  // namespace

bool is_violated(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 const std::vector<Configuration>& path, double depth, int samples) {
  if (map.resolution() <= 2.0 * depth) return false;
  std::vector<BodyPoints> probes;
  for (const Body& body : robot.bodies) {
    const auto named = policies.find(body.part);
    const Policy policy = named == policies.end() ? Policy::not_occupied : named->second;
    if (body.shape.has_exact_distance() && is_moved(robot, body))
      probes.push_back({&body, policy, volumes_for(map, body.part), fcl_geometry(body.shape)});
  }
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k <= samples; ++k) {
      const LinkPoses poses = forward_kinematics(robot, path[i - 1] + (path[i] - path[i - 1]) * k / samples);
      for (const BodyPoints& probe : probes) {
        const Eigen::Isometry3d pose =
            poses[static_cast<std::size_t>(probe.body->link)] * probe.body->link_from_shape;
        if (is_inside_something(probe, pose, map, depth)) return true;
      }
    }
  }
  return false;
}

}  // namespace clearway::evidence
