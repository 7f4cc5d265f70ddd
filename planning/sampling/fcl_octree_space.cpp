#include "planning/sampling/fcl_octree_space.hpp"

#include <fcl/geometry/octree/octree.h>
#include <fcl/narrowphase/collision.h>
#include <octomap/OcTree.h>

#include <algorithm>

#include "planning/geometry/fcl_geometry.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/sampling/blocked_octree.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

using Geometry = fcl::CollisionGeometryd;

bool collide(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
             const Eigen::Isometry3d& pose_b) {
  fcl::CollisionResultd result;
  return fcl::collide(&a, pose_a, &b, pose_b, fcl::CollisionRequestd(), result) > 0;
}

}  // namespace

struct FclOctreeSpace::Scene {
  struct Blocked {  ///< voxels that bodies with one requirement share
    Requirement requirement;
    std::unique_ptr<fcl::OcTreed> tree;  ///< null when nothing is blocked
  };
  struct MovedBody {
    std::size_t body = 0, blocked = 0;
  };

  Robot robot;
  std::vector<std::shared_ptr<Geometry>> padded, plain;  ///< of each body; between bodies padding is not kept
  std::vector<MovedBody> moved;                          ///< the hand first: it touches most
  std::vector<Blocked> blocked;
  std::vector<BodyPair> pairs;

  std::size_t blocked_index(const Requirement& requirement) {
    for (std::size_t i = 0; i < blocked.size(); ++i) {
      if (blocked[i].requirement == requirement) return i;
    }
    blocked.push_back({requirement, nullptr});
    return blocked.size() - 1;
  }

  bool touches_map(const LinkPoses& poses) const {
    return std::any_of(moved.begin(), moved.end(), [&](const MovedBody& each) {
      if (!blocked[each.blocked].tree) return false;
      return collide(*blocked[each.blocked].tree, Eigen::Isometry3d::Identity(), *padded[each.body],
                     pose(poses, each.body));
    });
  }

  bool touches_itself(const LinkPoses& poses) const {
    return std::any_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
      const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
      const double reach =
          robot.bodies[a].shape.bounding_radius() + robot.bodies[b].shape.bounding_radius() + 1e-6;
      const Eigen::Isometry3d pose_a = pose(poses, a), pose_b = pose(poses, b);
      if ((pose_a.translation() - pose_b.translation()).norm() > reach) return false;
      return collide(*plain[a], pose_a, *plain[b], pose_b);
    });
  }

  Eigen::Isometry3d pose(const LinkPoses& poses, std::size_t body) const {
    return poses[static_cast<std::size_t>(robot.bodies[body].link)] * robot.bodies[body].link_from_shape;
  }
};

FclOctreeSpace::FclOctreeSpace(const ConfigurationSpace& space) {
  auto scene = std::make_unique<Scene>();
  scene->robot = space.robot();
  scene->pairs = self_collision_pairs(scene->robot);
  const double padding = space.options().padding;
  for (std::size_t i = 0; i < scene->robot.bodies.size(); ++i) {
    const Body& body = scene->robot.bodies[i];
    scene->plain.push_back(fcl_geometry(body.shape));
    scene->padded.push_back(fcl_geometry(body.shape.grown(padding)));
    if (!is_policed(scene->robot, body.link)) continue;
    const std::size_t blocked = scene->blocked_index(part_requirement(
        scene->robot, space.map(), body.part, space.policies().at(body.part), space.options().seen_within));
    scene->moved.insert(scene->moved.begin(), {i, blocked});
  }
  for (Scene::Blocked& blocked : scene->blocked) {
    const auto tree = blocked_octree(space.map(), blocked.requirement);
    if (tree->size() > 0) blocked.tree = std::make_unique<fcl::OcTreed>(tree);
  }
  scene_ = std::move(scene);
}

FclOctreeSpace::~FclOctreeSpace() = default;
FclOctreeSpace::FclOctreeSpace(FclOctreeSpace&&) noexcept = default;

bool FclOctreeSpace::is_free(const Configuration& q) const {
  if (!limit_violation(scene_->robot, q).empty()) return false;
  const LinkPoses poses = forward_kinematics(scene_->robot, q);
  return !scene_->touches_map(poses) && !scene_->touches_itself(poses);
}

}  // namespace clearway
