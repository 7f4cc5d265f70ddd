#include "planning/arm_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

/// Rodrigues: I + sin K + (1 - cos) K^2 about the joint's axis.
ArmKinematics::ArmKinematics(const Robot& robot)
    : joints_(static_cast<int>(robot.dof())),
      map_from_base_(robot.map_from_base),
      poses_(robot.links.size(), Eigen::Isometry3d::Identity()),
      axes_(robot.links.size(), Eigen::Vector3d::Zero()),
      moments_(axes_) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    Mover mover;
    mover.parent = link.parent;
    mover.joint = link.joint;
    mover.multiplier = link.multiplier;
    mover.offset = link.offset;
    mover.translation = link.parent_from_link.translation();
    mover.still = link.parent_from_link.linear();
    mover.sine.setZero();
    mover.cosine.setZero();
    mover.axis.setZero();
    if (link.joint >= 0) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
      const Eigen::Vector3d& axis = joint.axis;
      mover.axis = link.multiplier * (link.parent_from_link.linear() * axis);
      mover.turns = joint.kind == JointKind::revolute;
      if (!mover.turns) mover.translation += link.offset * (link.parent_from_link.linear() * axis);
      if (mover.turns) {
        Eigen::Matrix3d cross;
        cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
        mover.still = link.parent_from_link.linear() * (Eigen::Matrix3d::Identity() + cross * cross);
        mover.sine = link.parent_from_link.linear() * cross;
        mover.cosine = -link.parent_from_link.linear() * cross * cross;
      }
    }
    movers_.push_back(mover);
    chains_.push_back(link.parent < 0 ? std::vector<int>{} : chains_[static_cast<std::size_t>(link.parent)]);
    if (link.joint >= 0) chains_.back().push_back(static_cast<int>(i));
  }
}

void ArmKinematics::place(const Configuration& q) {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    const Eigen::Isometry3d& parent =
        mover.parent < 0 ? map_from_base_ : poses_[static_cast<std::size_t>(mover.parent)];
    const auto turned = parent.linear();
    Eigen::Isometry3d& pose = poses_[i];
    Eigen::Vector3d translation = mover.translation;
    if (mover.joint < 0) {
      pose.linear().noalias() = turned * mover.still;
    } else {
      axes_[i].noalias() = turned * mover.axis;
      if (mover.turns) {
        const double value = mover.multiplier * q[mover.joint] + mover.offset;
        const Eigen::Matrix3d linear =
            mover.still + std::sin(value) * mover.sine + std::cos(value) * mover.cosine;
        pose.linear().noalias() = turned * linear;
      } else {  // the axis holds the multiplier, the translation the offset
        translation += q[mover.joint] * mover.axis;
        pose.linear().noalias() = turned * mover.still;
      }
    }
    pose.translation().noalias() = turned * translation;
    pose.translation() += parent.translation();
    if (mover.turns) moments_[i] = pose.translation().cross(axes_[i]);
  }
}

void ArmKinematics::rate(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                         std::span<double> gradient) const {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  const Eigen::Vector3d turn = point.cross(normal);
  for (const int i : chains_[static_cast<std::size_t>(link)]) {
    const auto place = static_cast<std::size_t>(i);
    gradient[static_cast<std::size_t>(movers_[place].joint)] +=
        movers_[place].turns ? axes_[place].dot(turn) + moments_[place].dot(normal)
                             : axes_[place].dot(normal);
  }
}

}  // namespace clearway
