#pragma once

// Not part of the installed library.

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "planning/batch/edge_pieces.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/space/body_collision.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/space/known_clearances.hpp"

namespace clearway {

/// Poses of links at both ends of an edge and half way, for who knows them: those of forward_kinematics at
/// from, from + 0.5 (to - from) and to, bit for bit.
struct EdgePoses {
  LinkPoses begin, middle, end;
};

/// What a ConfigurationSpace knows: the robot, what blocks each of its bodies, and bounds on their motion.
/// Its constructor only stores what is given; ConfigurationSpace fills in the rest.
struct CollisionModel {
  CollisionModel(Robot given_robot, Snapshot snapshot, const SpaceOptions& space_options)
      : given(std::move(given_robot)), map(std::move(snapshot)), options(space_options) {}

  Robot given;  ///< as the caller knows it
  Robot robot;  ///< the same without_axisymmetric_joints but where that hides a contact: all that follows is
                ///< of this one
  Snapshot map;
  SpaceOptions options;
  std::map<std::string, Policy> policies;
  std::vector<BodyCollision> bodies;    ///< those that some joint moves
  std::vector<int> indices;             ///< of these in robot.bodies
  std::vector<Eigen::VectorXd> levers;  ///< of these: metres any point moves at most per unit of each joint
  std::vector<Eigen::VectorXd>
      turns;  ///< of these: radians any link below the body turns per unit of each joint
  std::vector<BodyPair> pairs;
  /// Bodies, pairs and fields at single precision, for many looks at once; null where that is of no use.
  std::unique_ptr<const SphereRobot> spheres;
  Eigen::VectorXd matters;  ///< of each joint 1 when it moves a body, or a pair of them, else 0

  const Eigen::Isometry3d& pose(const LinkPoses& map_from_link, std::size_t body) const {
    return map_from_link[static_cast<std::size_t>(bodies[body].body().link)];
  }
  /// Right size, finite and within the joint limits.
  bool is_within_limits(const Configuration& q) const;

  /// ConfigurationSpace::is_free by exact shapes from the start, without `spheres`.
  bool is_free_by_shapes(const Configuration& q) const;

  /// Bodies i as i, pairs k as (number of bodies + k).
  std::size_t members() const { return bodies.size() + pairs.size(); }
  /// How far any point of a body moves, or how much a pair approaches, at most per unit of each joint.
  const Eigen::VectorXd& rates(std::size_t member) const {
    return member < bodies.size() ? levers[member] : pairs[member - bodies.size()].approach;
  }
  /// The same when the joints move by |dq|, metres.
  double motion(std::size_t member, const Eigen::VectorXd& abs_dq) const {
    return rates(member).dot(abs_dq) * (1.0 + 1e-9);
  }
  /// The proof of ConfigurationSpace::is_edge_free for some of the members; both ends within the limits.
  /// What is known and remembered saves time and changes nothing.
  /// @param recent of each body.
  bool is_edge_free(const Configuration& from, const Configuration& to, const std::vector<int>& members,
                    std::vector<RecentCubes>& recent, KnownClearances* known_from = nullptr,
                    KnownClearances* known_to = nullptr, const EdgePoses* poses = nullptr) const;

  /// The same for all members: by exact shapes from the start, without `spheres`.
  bool is_edge_free_by_shapes(const Configuration& from, const Configuration& to) const;

  /// The same for some of the members on parts of the edge alone.
  bool are_pieces_free(const Configuration& from, const Configuration& to,
                       const std::vector<EdgePieces::Piece>& pieces, const std::vector<int>& members) const;
};

}  // namespace clearway
