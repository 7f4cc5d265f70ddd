#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot/self_collision.hpp"

namespace clearway {

/// Two bodies of a robot that are near each other.
struct NearPair {
  int first = 0, second = 0;            ///< indices in Robot::bodies
  int first_link = 0, second_link = 0;  ///< that carry them
  double distance = 0.0;                ///< metres, never too large
  /// Near points, map frame; where the bodies overlap the middles of spheres that hold them.
  Eigen::Vector3d first_point = Eigen::Vector3d::Zero(), second_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit, from the first to the second
};

/// The pairs of self_collision_pairs that are nearer than some distance, for loops: most are ruled out by
/// spheres, then by the segments in their middles, or by the flat ends of cylinders, before `distance` is
/// asked. It allocates nothing after it is made.
class NearPairs {
 public:
  /// @param within metres, of each pair; negative: never. @param robot must live as long.
  NearPairs(const Robot& robot, const std::function<double(const BodyPair&)>& within);

  /// In the order of self_collision_pairs, valid until the next call; without pairs whose spheres have one
  /// middle.
  std::span<const NearPair> look(const LinkPoses& map_from_link);

  std::size_t size() const { return pairs_.size(); }  ///< of all pairs

 private:
  struct Placed {  ///< a body
    const Body* body;
    Sphere sphere;                                     ///< holds it; link frame
    bool has_axis;                                     ///< boxes and hulls have none
    Eigen::Vector3d half;                              ///< the axis' upper half, link frame
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of sphere and axis, map frame
    bool is_flat() const { return has_axis && !body->shape.is_rounded(); }
  };
  struct Pair {
    int first, second;
    double within;
    double spheres_apart;  ///< squared: middles as far apart as that are out of reach
    double axes_apart;     ///< squared; 0 where one has none
  };
  bool is_far(const Pair& pair, const LinkPoses& map_from_link) const;

  std::vector<Placed> bodies_;
  std::vector<Pair> pairs_;
  std::vector<NearPair> near_;
};

/// A sphere that holds a body, link frame.
Sphere sphere_around(const Body& body);

}  // namespace clearway
