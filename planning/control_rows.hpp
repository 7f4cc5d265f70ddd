#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "planning/arm_kinematics.hpp"
#include "planning/configuration_space.hpp"
#include "planning/nearest_cubes.hpp"
#include "planning/self_contact.hpp"

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
  std::size_t balls() const { return balls_.size(); }

 private:
  struct NearBody {
    int index = 0, link = 0;
    const Body* body = nullptr;
    Eigen::AlignedBox3d reach;  ///< voxels beyond it do not count
    Sphere bound;               ///< link frame
    std::size_t first_ball = 0, last_ball = 0;
  };
  struct Group {  ///< bodies with the same requirement
    NearestCubes cubes;
    const BlockedSpace* space;
    std::vector<NearBody> bodies;
  };
  struct Pair {
    int first, second, first_link, second_link;
    Sphere first_bound, second_bound;
  };
  struct NearBall {
    std::size_t body, ball;
    Eigen::Vector3d center;  ///< map frame
    bool is_close = false;
    std::size_t first_voxel = 0;  ///< of voxels_: its own, and six more when it is close
  };
  struct Candidate {
    std::uint64_t key;
    Eigen::Vector3i voxel;
    Eigen::Vector3d towards;
    double behind;
  };
  void find_near_balls(const Group& group);
  void look_up(const BlockedSpace& space, std::size_t count, bool closely);
  void keep_near(const Group& group, bool closely);
  void find_cubes(Group& group);
  void gather(const Group& group, const NearBall& ball);
  void gather_within_reach(const Group& group, const NearBall& ball, double within);
  Eigen::Vector3d center(const Eigen::Vector3i& voxel) const {
    return (voxel.cast<double>().array() + 0.5) * resolution_;
  }
  void add_candidate(const Eigen::Vector3i& voxel, const Eigen::Vector3d& towards, double behind);
  void close_body(const NearBody& body);
  void pair_rows();
  void append(const ControlRow& row, int link, int other_link);
  const Eigen::Isometry3d& pose(int link) const {
    return kinematics_.map_from_link()[static_cast<std::size_t>(link)];
  }

  const Robot* robot_;
  double padding_, reach_, close_, resolution_;  ///< reach and close: from a body's surface, padding included
  ArmKinematics kinematics_;
  std::vector<Group> groups_;
  std::vector<Pair> pairs_;
  std::vector<Sphere> balls_;                  ///< link frames
  std::vector<NearBall> near_;                 ///< of the group under way
  std::vector<double> x_, y_, z_, clearance_;  ///< of the points that are looked up
  std::vector<Eigen::Vector3i> voxels_;
  std::vector<NearestCubes::Offset> offsets_;  ///< of the voxels
  std::vector<Eigen::Vector3d> visited_;
  std::vector<Candidate> candidates_;  ///< of the body under way
  std::vector<ControlRow> rows_;
  std::vector<double> gradients_, second_gradient_;
};

}  // namespace clearway
