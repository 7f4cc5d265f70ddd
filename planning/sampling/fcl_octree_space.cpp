#include "planning/sampling/fcl_octree_space.hpp"

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <octomap/OcTree.h>

#include <algorithm>

#include "planning/geometry/convex_hull.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/sampling/blocked_octree.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

using Geometry = fcl::CollisionGeometryd;

/// The hull of the corners, each replaced by the corners of a cube of half-edge `padding`.
std::shared_ptr<Geometry> convex_geometry(const Shape& shape, double padding) {
  std::vector<Eigen::Vector3d> corners = shape.vertices();
  if (padding > 0.0) {
    corners.clear();
    for (const Eigen::Vector3d& at : shape.vertices()) {
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d side((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
        corners.push_back(at + padding * side);
      }
    }
    corners = hull_corners(std::move(corners));
  }
  const auto triangles = hull_triangles(corners);
  if (triangles.empty()) return nullptr;  // flat
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& triangle : triangles) {
    faces->push_back(3);
    faces->insert(faces->end(), triangle.begin(), triangle.end());
  }
  return std::make_shared<fcl::Convexd>(std::make_shared<std::vector<fcl::Vector3d>>(corners),
                                        static_cast<int>(triangles.size()), faces);
}

struct PlacedGeometry {
  std::shared_ptr<Geometry> geometry;
  Eigen::Isometry3d link_from_geometry = Eigen::Isometry3d::Identity();
};

PlacedGeometry geometry_of(const Body& body, double padding) {
  const Shape& shape = body.shape;
  PlacedGeometry placed{nullptr, body.link_from_shape};
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      placed.geometry = std::make_shared<fcl::Sphered>(shape.radius() + padding);
      break;
    case Shape::Kind::capsule:
      placed.geometry = std::make_shared<fcl::Capsuled>(shape.radius() + padding, shape.length());
      break;
    case Shape::Kind::cylinder:
      placed.geometry =
          std::make_shared<fcl::Cylinderd>(shape.radius() + padding, shape.length() + 2 * padding);
      break;
    case Shape::Kind::box:
      placed.geometry = std::make_shared<fcl::Boxd>((shape.edges().array() + 2 * padding).matrix().eval());
      break;
    case Shape::Kind::convex:
      placed.geometry = convex_geometry(shape, padding);
      break;
  }
  if (!placed.geometry) {  // a flat hull becomes the box around it
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : shape.vertices()) box.extend(corner);
    placed.geometry =
        std::make_shared<fcl::Boxd>((box.sizes().cwiseMax(1e-9).array() + 2 * padding).matrix().eval());
    placed.link_from_geometry = body.link_from_shape * Eigen::Translation3d(box.center());
  }
  return placed;
}

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
  std::vector<PlacedGeometry> padded, plain;  ///< of each body; padding is not kept between bodies
  std::vector<MovedBody> moved;               ///< the hand first: it touches most
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
      const PlacedGeometry& shape = padded[each.body];
      return collide(*blocked[each.blocked].tree, Eigen::Isometry3d::Identity(), *shape.geometry,
                     pose(poses, each.body) * shape.link_from_geometry);
    });
  }

  bool touches_itself(const LinkPoses& poses) const {
    return std::any_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
      const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
      const auto pose_of = [&](std::size_t i) { return pose(poses, i) * robot.bodies[i].link_from_shape; };
      const double reach =
          robot.bodies[a].shape.bounding_radius() + robot.bodies[b].shape.bounding_radius() + 1e-6;
      if ((pose_of(a).translation() - pose_of(b).translation()).norm() > reach) return false;
      return collide(*plain[a].geometry, pose(poses, a) * plain[a].link_from_geometry, *plain[b].geometry,
                     pose(poses, b) * plain[b].link_from_geometry);
    });
  }

  const Eigen::Isometry3d& pose(const LinkPoses& poses, std::size_t body) const {
    return poses[static_cast<std::size_t>(robot.bodies[body].link)];
  }
};

FclOctreeSpace::FclOctreeSpace(const ConfigurationSpace& space) {
  auto scene = std::make_unique<Scene>();
  scene->robot = space.robot();
  scene->pairs = self_collision_pairs(scene->robot);
  const double padding = space.options().padding;
  for (std::size_t i = 0; i < scene->robot.bodies.size(); ++i) {
    const Body& body = scene->robot.bodies[i];
    scene->plain.push_back(geometry_of(body, 0.0));
    scene->padded.push_back(geometry_of(body, padding));
    if (!is_moved(scene->robot, body.link)) continue;
    const std::size_t blocked = scene->blocked_index(part_requirement(
        space.map(), body.part, space.policies().at(body.part), space.options().seen_within));
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
