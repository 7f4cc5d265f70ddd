#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "planning/arm_kinematics.hpp"
#include "planning/ball_cubes.hpp"
#include "planning/configuration_space.hpp"
#include "planning/local_step.hpp"
#include "planning/near_pairs.hpp"

namespace clearway {

/// A pair that limits the next step: a body and a blocked voxel, or two bodies.
struct ControlRow {
  int body = 0;
  int other = -1;         ///< the second body; -1: a voxel
  double distance = 0.0;  ///< metres, padding subtracted, never larger than that between the two
  /// How much farther than the nearest voxel of the same ball; 0 for the nearest one itself.
  double behind = 0.0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< on the body
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the body to the voxel or other body
};

/// The rows of a control step, found in microseconds. Balls that hold the bodies are looked up in the
/// distance field, then the cover balls of those that may be near something: from one cell each, then
/// closely. For each ball that is near, the cube nearest to its voxel is taken; where it is nearer than
/// `close_distance`, those nearest to the eight voxels about its middle and to the six that lie three away
/// along the map's axes, too. Each cube is one row for a body, with distance, point and direction by the
/// body's exact shape. So a cube is known before it becomes the nearest one, the far wall of a corridor is
/// known, and neighbouring cubes take over from each other without a jump (see ControlStep). Cubes that the
/// body cannot reach do not count. Then come pairs of bodies. One object for each robot and thread; it
/// allocates nothing once it has seen its largest set of rows.
class ControlRows {
 public:
  /// Metres: rows are wanted below `influence_distance`. @param space must live as long.
  ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance);
  /// For a control step with these dampers: pairs of bodies that no step of at most max_step a joint can
  /// bring to their damper have no row. `close_distance` is halfway between d_s and d_i.
  ControlRows(const ConfigurationSpace& space, const DamperOptions& damper);
  ~ControlRows();

  /// Kinematics and rows at q. @pre q is finite, of the robot's size
  void look(const Configuration& q);
  /// The two halves of `look`.
  void place(const Configuration& q) { kinematics_.place(q); }
  void find_rows();

  const Robot& robot() const { return *robot_; }
  const ArmKinematics& kinematics() const { return kinematics_; }
  std::span<const ControlRow> rows() const { return rows_; }
  /// n^T J of row i, per unit of each joint.
  std::span<const double> gradient(std::size_t i) const {
    return std::span(gradients_).subspan(i * robot_->dof(), robot_->dof());
  }
  std::size_t balls() const;

 private:
  ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance,
              const std::function<double(const BodyPair&)>& pair_reach);
  struct GuardedBodies {  ///< with the same requirement
    const BlockedSpace* space;
    NearBalls balls;
    BallCubes cubes;
    std::vector<int> bodies;  ///< indices in Robot::bodies
  };
  void add_body(int index, const BlockedSpace* space);
  void cube_rows(int body, std::span<const BodyCube> cubes);
  void pair_rows();
  void append(const ControlRow& row, int link, const NearPair* pair);
  const Eigen::Isometry3d& pose(int link) const {
    return kinematics_.map_from_link()[static_cast<std::size_t>(link)];
  }

  const Robot* robot_;
  double padding_, reach_, close_, resolution_;  ///< reach and close: from a body's surface, padding included
  ArmKinematics kinematics_;
  std::vector<GuardedBodies> guarded_;
  NearPairs pairs_;
  std::vector<ControlRow> rows_;
  std::vector<double> gradients_;  ///< of the rows, and one more under way
  std::vector<double> second_gradient_;
};

}  // namespace clearway
