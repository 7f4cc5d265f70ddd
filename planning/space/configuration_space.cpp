#include "planning/space/configuration_space.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/rigid_pose.hpp"
#include "planning/space/collision_model.hpp"
#include "planning/space/part_policies.hpp"
#include "planning/space/robot_geometry.hpp"

namespace clearway {
namespace {

/// Poses of the links at the configuration under test; kept per thread, so that a check allocates nothing.
LinkPoses& scratch_poses() {
  thread_local LinkPoses poses;
  return poses;
}

void check_options(const SpaceOptions& options) {
  if (!std::isfinite(options.padding) || options.padding < 0.0) {
    throw std::invalid_argument("padding must be a finite length not below 0, in metres");
  }
  if (!std::isfinite(options.max_distance) || options.max_distance < 0.0) {
    throw std::invalid_argument("max_distance must be a finite length not below 0, in metres");
  }
  if (!std::isfinite(options.edge_resolution) || options.edge_resolution <= 0.0) {
    throw std::invalid_argument("edge_resolution must be a finite length above 0, in radians or metres");
  }
}

/// What no file can say, but a robot that was made in memory. @throws std::invalid_argument
class RobotCheck {
 public:
  explicit RobotCheck(const Robot& robot) : robot_(robot) {}

  void run() const {
    require_pose(robot_.map_from_base, "map_from_base");
    if (robot_.joints.empty()) refuse("it has no joints, expected at least one");
    for (const Joint& joint : robot_.joints) check(joint);
    for (std::size_t i = 0; i < robot_.links.size(); ++i) check(robot_.links[i], static_cast<int>(i));
    for (const Body& body : robot_.bodies) check(body);
    if (!is_index(robot_.tip_link, robot_.links)) refuse("tip_link is none of its links");
    require_pose(robot_.link_from_tip, "link_from_tip");
    for (const auto& [first, second] : robot_.exempt)
      if (!is_index(first, robot_.bodies) || !is_index(second, robot_.bodies))
        refuse("a pair in `exempt` is of bodies that it does not have");
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument("robot " + quote(robot_.name) + ": " + what);
  }
  template <typename Item>
  static bool is_index(int index, const std::vector<Item>& list) {
    return index >= 0 && index < static_cast<int>(list.size());
  }
  void require_pose(const Eigen::Isometry3d& pose, const std::string& name) const {
    if (is_rotation(pose.linear()) && pose.matrix().allFinite()) return;
    refuse(name + " is no rigid pose, expected finite numbers and a rotation without scale or mirror");
  }
  void require_axis(const Eigen::Vector3d& axis, const std::string& whose) const {
    if (!(std::abs(axis.norm() - 1.0) <= 1e-6)) refuse(whose + " has an axis that is no unit vector");
  }
  void check(const Joint& joint) const {
    if (!(joint.lower <= joint.upper))
      refuse("joint " + quote(joint.name) +
             " has limits that are none, expected a lower one that is not above the upper");
    require_axis(joint.axis, "joint " + quote(joint.name));
  }
  void check(const Link& link, int index) const {
    const std::string name = "link " + quote(link.name);
    const bool is_rooted = index == 0 ? link.parent == -1 : link.parent >= 0 && link.parent < index;
    if (!is_rooted) refuse(name + " has a parent that does not come before it, expected parents first");
    if (link.joint != -1 && !is_index(link.joint, robot_.joints))
      refuse(name + " is moved by a joint that it does not have");
    require_pose(link.parent_from_link, "parent_from_link of " + name);
    if (!std::isfinite(link.multiplier) || !std::isfinite(link.offset))
      refuse(name + " has a multiplier or an offset that is not finite");
    if (!link.own_axis.isZero(0.0)) require_axis(link.own_axis, name);
  }
  void check(const Body& body) const {
    const std::string name = "a body of part " + quote(body.part);
    if (!is_index(body.link, robot_.links)) refuse(name + " is on a link that it does not have");
    require_pose(body.link_from_shape, "link_from_shape of " + name);
    if (body.cover.empty())
      refuse(name +
             " has no cover, expected the spheres of its shape's sphere_cover(), in the frame of its link");
    const auto is_sound = [](const Sphere& sphere) {
      return sphere.center.allFinite() && std::isfinite(sphere.radius) && sphere.radius > 0.0;
    };
    if (!std::all_of(body.cover.begin(), body.cover.end(), is_sound))
      refuse(name + " has a cover with a sphere that is none, expected finite centres and radii above 0");
  }

  const Robot& robot_;
};

/// As far as the largest body is wide: farther away, edges are proved in one piece anyway.
double chosen_max_distance(const Robot& robot, double resolution) {
  double largest = 0.0;
  for (const Body& body : robot.bodies) largest = std::max(largest, body.shape.bounding_radius());
  return std::max(largest, 8.0 * resolution);
}

constexpr double most_field_cells = 4e8;  ///< a field of more may take more memory than there is for one

double cells_in(const Eigen::AlignedBox3d& region, double resolution) {
  return (region.sizes().array() / resolution).prod();
}

/// Where a requirement has to be known: as far as the robot reaches, so that fields of a map that grows
/// follow it. Of a reach that is too large for that, only about the map. Under `not_occupied` nothing outside
/// the map blocks; under the other policies everything outside it does, so that one layer of voxels around it
/// stands for all of them. `wanted`: how far beyond its reach the robot has to know of blocked voxels,
/// metres.
Eigen::AlignedBox3d region_of(const Requirement& requirement, Eigen::AlignedBox3d reach, const Snapshot& map,
                              double wanted) {
  constexpr double most_cells = 1 << 25, farthest_cell = 1 << 15, edge_of_tile = 32;  // at most
  const double resolution = map.resolution();
  const auto grown = [](Eigen::AlignedBox3d box, double by) {
    return Eigen::AlignedBox3d(box.min().array() - by, box.max().array() + by);
  };
  const double margin = requirement.policy == Policy::not_occupied ? wanted : resolution;
  reach = grown(reach, wanted);
  const double farthest = std::max(-reach.min().minCoeff(), reach.max().maxCoeff());
  if ((reach.sizes().array() / resolution + edge_of_tile).prod() <= most_cells &&
      farthest <= farthest_cell * resolution)
    return reach;
  const Eigen::AlignedBox3d bounds = map.bounds();
  const Eigen::AlignedBox3d region = bounds.isEmpty() ? bounds : reach.intersection(grown(bounds, margin));
  if (!region.isEmpty()) return region;
  // Nothing in reach is known, or all that is lies too far away to matter: any voxel will do.
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(resolution)};
}

}  // namespace

ConfigurationSpace::ConfigurationSpace(Robot robot, Snapshot map, const Policies& policies,
                                       const SpaceOptions& options)
    : model_(std::make_shared<CollisionModel>(std::move(robot), std::move(map), options)) {
  CollisionModel& model = *model_;
  RobotCheck(model.given).run();
  const std::shared_ptr<const RobotGeometry> geometry = robot_geometry(model.given);
  model.robot = model.given;
  model.robot.bodies = geometry->robot.bodies;
  check_options(options);
  if (model.options.max_distance == 0.0) {
    model.options.max_distance = chosen_max_distance(model.robot, model.map.resolution());
  }
  model.policies = part_policies(model.given, model.map, policies);  // holders of loads are links' own bodies
  require_seen_within(options.seen_within, model.map, model.policies);
  std::vector<std::pair<Requirement, Eigen::AlignedBox3d>> reaches;  // one region for each requirement
  const auto reach_of = [&](const Requirement& requirement) -> Eigen::AlignedBox3d& {
    for (auto& [known, box] : reaches) {
      if (known == requirement) return box;
    }
    return reaches.emplace_back(requirement, Eigen::AlignedBox3d()).second;
  };
  const auto requirement_of = [&](const Body& body) {
    return part_requirement(model.given, model.map, body.part, model.policies.at(body.part),
                            options.seen_within);
  };
  for (const RobotGeometry::Policed& policed : geometry->policed)
    reach_of(requirement_of(policed.geometry->body)).extend(policed.reach);
  model.bodies.reserve(geometry->policed.size());
  for (const RobotGeometry::Policed& policed : geometry->policed) {
    const Requirement requirement = requirement_of(policed.geometry->body);
    const double max_distance = model.options.max_distance, resolution = model.map.resolution();
    const double least = options.padding + resolution;
    Eigen::AlignedBox3d region =
        region_of(requirement, reach_of(requirement), model.map, std::max(max_distance, least));
    if (cells_in(region, resolution) > most_field_cells)  // as far as fields know distances, then
      region = region_of(requirement, reach_of(requirement), model.map,
                         std::max(std::min(max_distance, BlockedSpace::most_voxels * resolution), least));
    Eigen::AlignedBox3d counts = policed.reach;  // voxels that can matter to the body
    const double rounding =
        1e-9 * (1.0 + counts.min().cwiseAbs().maxCoeff() + counts.max().cwiseAbs().maxCoeff());
    counts.min().array() -= options.padding + rounding;
    counts.max().array() += options.padding + rounding;
    model.bodies.emplace_back(policed.geometry, model.map.blocked_space(requirement, region, max_distance),
                              counts);
    model.indices.push_back(policed.index);
    model.levers.push_back(policed.levers);
    model.turns.push_back(policed.turns);
  }
  model.pairs = geometry->pairs;
  model.matters = geometry->matters;
  std::vector<BlockedBody> blocked;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    blocked.push_back(
        {&model.robot.bodies[static_cast<std::size_t>(model.indices[i])], &model.bodies[i].space()});
  model.spheres = sphere_robot(model.robot, blocked, model.pairs, model.options.padding);
}

const Robot& ConfigurationSpace::robot() const { return model_->given; }
const Snapshot& ConfigurationSpace::map() const { return model_->map; }
const SpaceOptions& ConfigurationSpace::options() const { return model_->options; }
const std::map<std::string, Policy>& ConfigurationSpace::policies() const { return model_->policies; }

const BlockedSpace* ConfigurationSpace::blocked_space(int body) const {
  const auto found = std::find(model_->indices.begin(), model_->indices.end(), body);
  if (found == model_->indices.end()) return nullptr;
  return &model_->bodies[static_cast<std::size_t>(found - model_->indices.begin())].space();
}

void ConfigurationSpace::renew() const {
  for (const BodyCollision& body : model_->bodies) body.space().renew();
}

bool CollisionModel::is_within_limits(const Configuration& q) const {
  return std::equal(robot.joints.begin(), robot.joints.end(), q.begin(), q.end(),
                    [](const Joint& joint, double value) {
                      return std::isfinite(value) && value >= joint.lower && value <= joint.upper;
                    });
}

bool CollisionModel::is_free_by_shapes(const Configuration& q) const {
  if (!is_within_limits(q)) return false;
  LinkPoses& poses = scratch_poses();
  forward_kinematics(robot, q, poses);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].is_clear(pose(poses, i), options.padding)) return false;
  }
  return std::all_of(pairs.begin(), pairs.end(),
                     [&](const BodyPair& pair) { return is_apart(robot, pair, poses, 0.0); });
}

double ConfigurationSpace::clearance(const Configuration& q, double at_most) const {
  const CollisionModel& model = *model_;
  if (std::isnan(at_most)) throw std::invalid_argument("clearance: at_most is no number, expected metres");
  if (!model.is_within_limits(q)) return 0.0;
  LinkPoses& poses = scratch_poses();
  forward_kinematics(model.robot, q, poses);
  double least = std::min(at_most, model.options.max_distance);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const BodyCollision& body = model.bodies[i];
    const double padding = model.options.padding;
    const double quick = body.quick_clearance(model.pose(poses, i)) - padding;
    if (quick >= least) continue;
    // Near a blocked voxel the spheres stand out too far to decide; the exact shape does, in a small box.
    const double slack = body.cover_excess() + 2.0 * model.map.resolution();
    if (quick > 2.0 * slack) {
      least = quick;
      continue;
    }
    const double limit = std::min(least, std::max(quick, 0.0) + slack) + padding;
    least = std::min(least, body.exact_clearance(model.pose(poses, i), limit) - padding);
  }
  for (const BodyPair& pair : model.pairs) {
    if (!is_apart(model.robot, pair, poses, least)) {
      least = std::min(least, pair_distance(model.robot, pair, poses).lower);
    }
  }
  return least;
}

}  // namespace clearway
