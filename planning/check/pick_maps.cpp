#include "planning/check/pick_maps.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/maps/freed_voxels.hpp"
#include "planning/check/path_check_shape.hpp"

namespace clearway::check {
namespace {

constexpr double skin = 1e-6;  ///< m that the object reaches into a voxel that is its own

Eigen::AlignedBox3d box_of(const Shape& shape, const Eigen::Isometry3d& pose, double margin) {
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    box.min()[axis] = -farthest(shape, pose, -unit) - margin;
    box.max()[axis] = farthest(shape, pose, unit) + margin;
  }
  return box;
}

/// Centres of the voxels that meet a box and pass `test`.
template <class Test>
std::vector<Eigen::Vector3d> voxels_in(const Eigen::AlignedBox3d& box, double edge, const Test& test) {
  const auto cell = [&](double x) { return static_cast<int>(std::floor(x / edge)); };
  std::vector<Eigen::Vector3d> voxels;
  for (int x = cell(box.min().x()); x <= cell(box.max().x()); ++x)
    for (int y = cell(box.min().y()); y <= cell(box.max().y()); ++y)
      for (int z = cell(box.min().z()); z <= cell(box.max().z()); ++z) {
        const Eigen::Vector3d center = (Eigen::Array3d(x, y, z) + 0.5) * edge;
        if (test(center)) voxels.push_back(center);
      }
  return voxels;
}

}  // namespace

namespace {

std::vector<Eigen::Vector3d> voxels_of_object(const PickTerms& terms) {
  const Pick& pick = terms.pick;
  const Eigen::Isometry3d& pose = pick.map_from_object;
  const double edge = terms.plan.map.resolution(), plane = lowest(terms.shape, pose);
  const Robot robot = terms.standing(pose, true);
  const FclBodies bodies(robot);
  const std::size_t body = robot.bodies.size() - 1;
  const auto is_own = [&](const Eigen::Vector3d& center) {
    if (!(center.z() - edge / 2 >= plane - skin)) return false;
    if (pick.margin > 0.0) return bodies.cube_distance(body, pose, center, edge) <= pick.margin;
    return bodies.touches_cube(body, pose, center, edge - 2.0 * skin);
  };
  return voxels_in(box_of(terms.shape, pose, pick.margin), edge, is_own);
}

bool is_any_occupied(const Snapshot& map, const std::vector<Eigen::Vector3d>& voxels) {
  return std::any_of(voxels.begin(), voxels.end(), [&](const Eigen::Vector3d& center) {
    const VoxelState state = map.state(center);
    return state == VoxelState::occupied || state == VoxelState::conflict;
  });
}

}  // namespace

bool is_object_occupied(const PickTerms& terms) {
  return is_any_occupied(terms.plan.map, voxels_of_object(terms));
}

Snapshot without_object(const PickTerms& terms) {
  return with_free_voxels(terms.plan.map, voxels_of_object(terms), false);
}

namespace {

/// Centres of the voxels of the layer of what the object stands on there, and so much deeper.
std::vector<Eigen::Vector3d> layer_at(const PickTerms& terms, const Eigen::Isometry3d& map_from_object,
                                      double deeper) {
  const double edge = terms.plan.map.resolution(), wide = layer_reach(edge, terms.padding);
  const double plane = lowest(terms.shape, map_from_object);
  Eigen::AlignedBox3d about = box_of(terms.shape, map_from_object, wide);
  about.min().z() -= deeper;
  const auto is_layer = [&](const Eigen::Vector3d& center) {
    const Eigen::Array3d low = center.array() - edge / 2, high = center.array() + edge / 2;
    return (low.head<2>() >= about.min().array().head<2>() - skin).all() &&
           (high.head<2>() <= about.max().array().head<2>() + skin).all() &&
           low.z() >= plane - wide - deeper - skin && high.z() <= plane + edge + skin;
  };
  return voxels_in(about, edge, is_layer);
}

}  // namespace

Snapshot without_layer(const PickTerms& terms, const Snapshot& map,
                       const Eigen::Isometry3d& map_from_object) {
  return with_free_voxels(map, layer_at(terms, map_from_object, 0.0), true);
}

bool is_layer_occupied(const PickTerms& terms, const Snapshot& map,
                       const Eigen::Isometry3d& map_from_object) {
  return is_any_occupied(map, layer_at(terms, map_from_object, terms.plan.map.resolution()));
}

}  // namespace clearway::check
