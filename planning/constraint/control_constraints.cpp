#include "planning/constraint/control_constraints.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "planning/geometry/voxel_distance.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Constraints of a sphere at most, as a rule.
constexpr std::size_t constraints_of_sphere = 14;

}  // namespace

ControlConstraints::ControlConstraints(const ConfigurationSpace& space, double influence_distance,
                                       double close_distance)
    : ControlConstraints(space, Binding{influence_distance, influence_distance, 0.0,
                                        std::vector<double>(space.robot().dof()),
                                        std::min(close_distance, influence_distance)}) {}

ControlConstraints::ControlConstraints(const ConfigurationSpace& space, const DamperOptions& damper)
    : ControlConstraints(space, binding_of(damper)) {}

ControlConstraints::ControlConstraints(const ConfigurationSpace& space, Binding binding)
    : robot_(&space.robot()),
      padding_(space.options().padding),
      resolution_(space.map().resolution()),
      binding_(std::move(binding)),
      kinematics_(space.robot()),
      pairs_(space.robot(), [&](const BodyPair& pair) {
        return binding_.distance(
            std::inner_product(binding_.steps.begin(), binding_.steps.end(), pair.approach.data(), 0.0));
      }) {
  for (int i = 0; i < static_cast<int>(robot_->bodies.size()); ++i) {
    if (space.blocked_space(i) != nullptr) add_body(i, space.blocked_space(i));
  }
  second_gradient_.resize(robot_->dof());
  // What a look may find at most, as a rule: a loop must not wait for memory.
  const std::size_t most = constraints_of_sphere * spheres() + pairs_.size();
  constraints_.reserve(most);
  voxel_distances_.resize(most);
  gradients_.resize(robot_->dof() * (most + 1));
}

/// What cannot come to the bound of its damper in one step does not count.
ControlConstraints::Binding ControlConstraints::binding_of(const DamperOptions& damper) {
  const double margin = damper.influence_distance - damper.security_distance;
  Binding binding{damper.influence_distance,
                  damper.security_distance,
                  (1.0 + 1e-9) * margin / damper.xi,
                  {},
                  0.5 * (damper.influence_distance + damper.security_distance)};
  for (const double weight : damper.weight) binding.steps.push_back(damper.max_step / weight);
  return binding;
}

ControlConstraints::~ControlConstraints() = default;

void ControlConstraints::add_body(int index, const BlockedSpace* space) {
  auto group = std::find_if(groups_.begin(), groups_.end(),
                            [&](const BodyGroup& known) { return known.space == space; });
  if (group == groups_.end()) {
    groups_.push_back({space, BroadPhase(*space), NearVoxels(*space), {}, {}, {}});
    group = groups_.end() - 1;
  }
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const Eigen::AlignedBox3d box = reach_box(*robot_, body);
  group->spheres.add(body.link, sphere_around(body), body.cover);
  group->cubes.add({box.min().array() - padding_, box.max().array() + padding_}, body.cover.size());
  group->bodies.push_back(index);
  group->bounds.push_back(sphere_around(body));
  group->reach.push_back({binding_.influence + padding_, binding_.close + padding_});
}

std::size_t ControlConstraints::spheres() const {
  return std::accumulate(groups_.begin(), groups_.end(), std::size_t{0},
                         [](std::size_t sum, const BodyGroup& group) { return sum + group.spheres.size(); });
}

void ControlConstraints::look(const Configuration& q) {
  kinematics_.place(q);
  find_constraints();
}

void ControlConstraints::find_constraints() {
  constraints_.clear();
  for (BodyGroup& group : groups_) {
    set_reach(group);
    const std::span<const NearSphere> spheres = group.spheres.look(kinematics_.map_from_link(), group.reach);
    if (spheres.empty()) continue;
    group.cubes.look(spheres);
    for (std::size_t first = 0, last = 0; first < spheres.size(); first = last) {
      while (last < spheres.size() && spheres[last].body == spheres[first].body) ++last;
      cube_constraints(group, spheres[first].body, group.cubes.gather(spheres, first, last));
    }
  }
  pair_constraints();
}

void ControlConstraints::set_reach(BodyGroup& group) const {
  if (binding_.per_move == 0.0) return;
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    const int link = robot_->bodies[static_cast<std::size_t>(group.bodies[i])].link;
    const Sphere& bound = group.bounds[i];
    const Eigen::Vector3d middle = pose(link).linear().lazyProduct(bound.center) + pose(link).translation();
    const double move = kinematics_.farthest_move(link, {middle, bound.radius}, binding_.steps);
    group.reach[i] = {binding_.distance(move) + padding_, binding_.close_distance(move) + padding_};
  }
}

/// A constraint for each cube that is near the body's exact shape.
void ControlConstraints::cube_constraints(const BodyGroup& group, int which,
                                          std::span<const NearVoxel> cubes) {
  if (cubes.empty()) return;
  const int index = group.bodies[static_cast<std::size_t>(which)];
  const double reach = group.reach[static_cast<std::size_t>(which)].near;
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const VoxelDistances distances(body.shape, pose(body.link) * body.link_from_shape, resolution_);
  voxel_distances_.resize(std::max(voxel_distances_.size(), cubes.size()));
  const auto found = std::span(voxel_distances_).first(cubes.size());
  distances.to(cubes, reach, found);
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    const NearVoxel& cube = cubes[i];
    VoxelDistance& to_voxel = found[i];
    if (to_voxel.distance >= reach) continue;
    if (to_voxel.normal.isZero(0.0)) {  // they overlap
      to_voxel.normal = (cube.center - cube.towards).stableNormalized();
      to_voxel.point = cube.center;
      if (to_voxel.normal.isZero(0.0)) continue;
    }
    append({index, -1, to_voxel.distance - padding_, cube.behind, to_voxel.point, to_voxel.normal}, body.link,
           nullptr);
  }
}

/// Constraints between bodies of the robot that are near each other.
void ControlConstraints::pair_constraints() {
  for (const NearPair& pair : pairs_.look(kinematics_.map_from_link())) {
    append({pair.first, pair.second, pair.distance, 0.0, pair.first_point, pair.direction}, pair.first_link,
           &pair);
  }
}

/// Constraints that no joint can change are left out.
void ControlConstraints::append(const ControlConstraint& constraint, int link, const NearPair* pair) {
  const std::size_t dof = robot_->dof(), begin = constraints_.size() * dof;
  gradients_.resize(std::max(gradients_.size(), begin + dof));
  const auto gradient = std::span(gradients_).subspan(begin, dof);
  kinematics_.rate(link, constraint.point, constraint.normal, gradient);
  if (pair != nullptr) {
    kinematics_.rate(pair->second_link, pair->second_point, constraint.normal, second_gradient_);
    std::transform(gradient.begin(), gradient.end(), second_gradient_.begin(), gradient.begin(),
                   std::minus<>());
  }
  if (std::any_of(gradient.begin(), gradient.end(), [](double rate) { return std::abs(rate) > 1e-12; }))
    constraints_.push_back(constraint);
}

}  // namespace clearway
