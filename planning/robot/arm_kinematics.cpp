#include "planning/robot/arm_kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "planning/geometry/four_lanes.hpp"

namespace clearway {

/// Rodrigues: I + sin K + (1 - cos) K^2 about the joint's axis.
ArmKinematics::ArmKinematics(const Robot& robot)
    : joints_(static_cast<int>(robot.dof())),
      map_from_base_(robot.map_from_base),
      poses_(robot.links.size(), Eigen::Isometry3d::Identity()) {
  int columns = 0;
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
      const Eigen::Vector3d& axis = axis_of(robot, link);
      mover.axis = link.multiplier * (link.parent_from_link.linear() * axis);
      mover.turns = kind_of(robot, link) == JointKind::revolute;
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
    chains_.push_back(link.parent < 0 ? std::vector<Moved>{}
                                      : chains_[static_cast<std::size_t>(link.parent)]);
    column_of_.push_back(link.joint >= 0 ? columns++ : -1);
    if (link.joint >= 0) chains_.back().push_back({column_of_.back(), link.joint});
    widths_.push_back(chains_.back().empty() ? 0 : lanes::padded(chains_.back().back().column + 1));
  }
  columns_ = lanes::padded(columns);
  screws_.resize(6 * static_cast<std::size_t>(columns_));
  rates_.resize(static_cast<std::size_t>(columns_));
  turns_.resize(static_cast<std::size_t>(columns_));
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    if (column_of_[i] >= 0 && movers_[i].turns)
      turns_[static_cast<std::size_t>(column_of_[i])] = (1.0 + 1e-12) * std::abs(movers_[i].multiplier);
  }
}

void ArmKinematics::place(const Configuration& q) {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    const Eigen::Isometry3d& parent =
        mover.parent < 0 ? map_from_base_ : poses_[static_cast<std::size_t>(mover.parent)];
    const Eigen::Matrix3d turned = parent.linear();
    Eigen::Isometry3d& pose = poses_[i];
    Eigen::Vector3d translation = mover.translation;
    if (mover.turns) {
      const double value = mover.multiplier * q[mover.joint] + mover.offset;
      const Eigen::Matrix3d linear =
          mover.still + std::sin(value) * mover.sine + std::cos(value) * mover.cosine;
      pose.linear() = turned.lazyProduct(linear);
    } else {  // the axis holds the multiplier, the translation the offset
      if (mover.joint >= 0) translation += q[mover.joint] * mover.axis;
      pose.linear() = turned.lazyProduct(mover.still);
    }
    pose.translation() = turned.lazyProduct(translation) + parent.translation();
    if (mover.joint < 0) continue;
    const Eigen::Vector3d axis = turned.lazyProduct(mover.axis);
    const Eigen::Vector3d turn = mover.turns ? axis : Eigen::Vector3d::Zero();
    const Eigen::Vector3d moment = mover.turns ? pose.translation().cross(axis) : axis;
    for (int k = 0; k < 3; ++k) {
      double* const numbers = screws_.data() + k * columns_ + column_of_[i];
      numbers[0] = turn[k];
      numbers[3 * columns_] = moment[k];
    }
  }
}

void ArmKinematics::rate(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                         std::span<double> gradient) const {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  const Eigen::Vector3d turn = point.cross(normal);
  for (int column = 0; column < widths_[static_cast<std::size_t>(link)]; column += lanes::width) {
    const auto row = [&](int k) { return lanes::load(screws_.data() + k * columns_ + column); };
    const lanes::Numbers turning = turn.x() * row(0) + turn.y() * row(1) + turn.z() * row(2);
    const lanes::Numbers moving = normal.x() * row(3) + normal.y() * row(4) + normal.z() * row(5);
    lanes::store(rates_.data() + column, turning + moving);
  }
  for (const Moved& moved : chains_[static_cast<std::size_t>(link)])
    gradient[static_cast<std::size_t>(moved.joint)] += rates_[static_cast<std::size_t>(moved.column)];
}

double ArmKinematics::farthest_move(int link, const Sphere& sphere, std::span<const double> steps) const {
  const Eigen::Vector3d& at = sphere.center;
  for (int column = 0; column < widths_[static_cast<std::size_t>(link)]; column += lanes::width) {
    const auto row = [&](int k) { return lanes::load(screws_.data() + k * columns_ + column); };
    const lanes::Numbers turn_x = row(0), turn_y = row(1), turn_z = row(2);
    const lanes::Numbers x = row(3) + at.z() * turn_y - at.y() * turn_z;
    const lanes::Numbers y = row(4) + at.x() * turn_z - at.z() * turn_x;
    const lanes::Numbers z = row(5) + at.y() * turn_x - at.x() * turn_y;
    const lanes::Numbers middle = lanes::root(x * x + y * y + z * z);
    lanes::store(rates_.data() + column, middle + sphere.radius * lanes::load(turns_.data() + column));
  }
  double sum = 0.0;
  for (const Moved& moved : chains_[static_cast<std::size_t>(link)])
    sum += rates_[static_cast<std::size_t>(moved.column)] * steps[static_cast<std::size_t>(moved.joint)];
  return sum;
}

}  // namespace clearway
