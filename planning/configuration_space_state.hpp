#pragma once

// Private to the sources of ConfigurationSpace.

#include <map>
#include <string>
#include <vector>

#include "planning/configuration_space.hpp"
#include "planning/guarded_body.hpp"
#include "planning/self_contact.hpp"

namespace clearway {

struct ConfigurationSpace::State {
  Robot robot;
  Snapshot map;
  SpaceOptions options;
  std::map<std::string, Policy> policies;
  std::vector<GuardedBody> bodies;      ///< those that some joint moves
  std::vector<int> indices;             ///< of these in robot.bodies
  std::vector<Eigen::VectorXd> levers;  ///< of these: metres any point moves at most per unit of each joint
  std::vector<Eigen::VectorXd>
      turns;  ///< of these: radians any link below the body turns per unit of each joint
  std::vector<BodyPair> pairs;

  const Eigen::Isometry3d& pose(const LinkPoses& map_from_link, std::size_t body) const {
    return map_from_link[static_cast<std::size_t>(bodies[body].body().link)];
  }
  /// Right size, finite and within the joint limits.
  bool is_within_limits(const Configuration& q) const;
};

}  // namespace clearway
