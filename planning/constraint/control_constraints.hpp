#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "planning/constraint/local_step.hpp"
#include "planning/constraint/near_pairs.hpp"
#include "planning/constraint/near_voxels.hpp"
#include "planning/robot/arm_kinematics.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A pair that limits the next step: a body and a blocked voxel, or two bodies.
struct ControlConstraint {
  int body = 0;
  int other = -1;         ///< the second body; -1: a voxel
  double distance = 0.0;  ///< metres, padding subtracted, never larger than that between the two
  /// How much farther than the nearest voxel of the same sphere; 0 for the nearest one itself.
  double behind = 0.0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< on the body
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the body to the voxel or other body
};

/// The constraints of a control step, found in microseconds. Spheres that hold the bodies are looked up in
/// the distance field, then the cover spheres of those that may be near something: from one cell each, then
/// closely. For each sphere that is near, the cube nearest to its voxel is taken; where it is nearer than
/// `close_distance`, those nearest to the eight voxels about its middle and to the six that lie three away
/// along the map's axes, too. Each cube is one constraint for a body, with distance, point and direction by
/// the body's exact shape. So a cube is known before it becomes the nearest one, the far wall of a corridor
/// is known, and neighbouring cubes take over from each other without a jump (see ControlStep). Cubes that
/// the body cannot reach do not count. Then come pairs of bodies. One object for each robot and thread; it
/// allocates nothing once it has seen its largest set of constraints.
class ControlConstraints {
 public:
  /// Metres: constraints are wanted below `influence_distance`. @param space must live as long.
  ControlConstraints(const ConfigurationSpace& space, double influence_distance, double close_distance);
  /// For a control step with these dampers: what no step of at most max_step a joint can bring to its damper
  /// has no constraint, be it a voxel or a pair of bodies; and only spheres that near look for voxels.
  /// `close_distance` is halfway between d_s and where a damper can bind, but no less than what one step can
  /// bring to d_s, and no more than halfway to d_i.
  ControlConstraints(const ConfigurationSpace& space, const DamperOptions& damper);
  ~ControlConstraints();

  /// Kinematics and constraints at q. @pre q is finite, of the robot's size
  void look(const Configuration& q);
  /// The two halves of `look`.
  void place(const Configuration& q) { kinematics_.place(q); }
  void find_constraints();

  const Robot& robot() const { return *robot_; }
  const ArmKinematics& kinematics() const { return kinematics_; }
  std::span<const ControlConstraint> constraints() const { return constraints_; }
  /// n^T J of constraint i, per unit of each joint.
  std::span<const double> gradient(std::size_t i) const {
    return std::span(gradients_).subspan(i * robot_->dof(), robot_->dof());
  }
  std::size_t spheres() const;

 private:
  /// What is farther does not count.
  struct Binding {
    double influence, security;  ///< metres: the farthest of all, and of what no step can bring nearer
    double per_move;             ///< for each metre that a step may bring it nearer
    std::vector<double> steps;   ///< of each joint at most
    double close;                ///< metres at most, where a sphere looks round
    double distance(double move) const { return std::min(influence, security + per_move * move); }
    double close_distance(double move) const {
      return std::min(close, security + std::max(1.0, 0.5 * per_move) * move);
    }
  };
  static Binding binding_of(const DamperOptions& damper);
  ControlConstraints(const ConfigurationSpace& space, Binding binding);
  struct BodyGroup {  ///< with the same requirement
    const BlockedSpace* space;
    BroadPhase spheres;
    NearVoxels cubes;
    std::vector<int> bodies;         ///< indices in Robot::bodies
    std::vector<Sphere> bounds;      ///< that hold them; link frame
    std::vector<SphereReach> reach;  ///< of each, padding included
  };
  void add_body(int index, const BlockedSpace* space);
  void set_reach(BodyGroup& group) const;
  void cube_constraints(const BodyGroup& group, int which, std::span<const NearVoxel> cubes);
  void pair_constraints();
  void append(const ControlConstraint& constraint, int link, const NearPair* pair);
  const Eigen::Isometry3d& pose(int link) const {
    return kinematics_.map_from_link()[static_cast<std::size_t>(link)];
  }

  const Robot* robot_;
  double padding_, resolution_;
  Binding binding_;
  ArmKinematics kinematics_;
  std::vector<BodyGroup> groups_;
  NearPairs pairs_;
  std::vector<VoxelDistance> voxel_distances_;  ///< of the body under way
  std::vector<ControlConstraint> constraints_;
  std::vector<double> gradients_;  ///< of the constraints, and one more under way
  std::vector<double> second_gradient_;
};

}  // namespace clearway
