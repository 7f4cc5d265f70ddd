#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Kinematics of one robot for loops: forward_kinematics with one sine and cosine a link, within rounding the
/// same, and the rows n^T J of points. An object for each thread; it allocates nothing after it is made.
class ArmKinematics {
 public:
  explicit ArmKinematics(const Robot& robot);

  /// @pre q has as many values as joints.
  void place(const Configuration& q);
  const LinkPoses& map_from_link() const { return poses_; }

  /// gradient = n^T J, the rate at which a point (map frame) that moves with `link` advances along n.
  void rate(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
            std::span<double> gradient) const;

  /// How far any point of a sphere (map frame) that moves with `link` advances at most at the present rates,
  /// when joint j moves by at most steps[j]: an upper bound of sum_j |n^T J_j| steps[j] for unit n.
  double farthest_move(int link, const Sphere& sphere, std::span<const double> steps) const;

 private:
  struct Mover {
    int parent = -1, joint = -1;
    bool turns = false;
    double multiplier = 1.0, offset = 0.0;
    Eigen::Vector3d axis;  ///< in the parent's frame, times the multiplier
    Eigen::Vector3d translation;
    Eigen::Matrix3d still, sine, cosine;  ///< parent_from_link = still + sin sine + cos cosine
  };
  int joints_ = 0;
  Eigen::Isometry3d map_from_base_;
  std::vector<Mover> movers_;  ///< of each link
  LinkPoses poses_;
  struct Moved {
    int column, joint;
  };
  int columns_ = 0;                         ///< links that a joint moves, padded to whole lanes
  std::vector<int> column_of_;              ///< of each link; -1: no joint moves it
  std::vector<double> screws_;              ///< rows: turn x, y, z, moment x, y, z (Pluecker, map frame)
  std::vector<int> widths_;                 ///< of each link: columns of its chain, padded
  std::vector<double> turns_;               ///< of each column: how fast it turns
  std::vector<std::vector<Moved>> chains_;  ///< of each link: itself and its parents that a joint moves
  mutable std::vector<double> rates_;       ///< of each column
};

}  // namespace clearway
