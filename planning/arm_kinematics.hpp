#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "planning/kinematics.hpp"

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
  std::vector<Eigen::Vector3d> axes_, moments_;  ///< of each link's joint, map frame: Pluecker coordinates
  std::vector<std::vector<int>> chains_;         ///< of each link: itself and its parents that a joint moves
};

}  // namespace clearway
