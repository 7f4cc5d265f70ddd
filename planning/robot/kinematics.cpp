#include "planning/robot/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/link_pose.hpp"

namespace clearway {
void forward_kinematics(const Robot& robot, const Configuration& q, LinkPoses& map_from_link) {
  map_from_link.resize(robot.links.size());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const Eigen::Isometry3d& map_from_parent =
        link.parent < 0 ? robot.map_from_base : map_from_link[static_cast<std::size_t>(link.parent)];
    place_link(map_from_parent, pose_on_parent(robot, link, link.joint < 0 ? 0.0 : q[link.joint]),
               map_from_link[i]);
  }
}

LinkPoses forward_kinematics(const Robot& robot, const Configuration& q) {
  if (q.size() != static_cast<Eigen::Index>(robot.dof()))
    throw std::invalid_argument("forward kinematics: got " + counted(q.size(), "value") + ", expected " +
                                std::to_string(robot.dof()) + ", one for each joint of robot " +
                                quote(robot.name));
  LinkPoses poses;
  forward_kinematics(robot, q, poses);
  return poses;
}

Eigen::Isometry3d tip_pose(const Robot& robot, const Configuration& q) {
  if (robot.tip_link < 0 || robot.tip_link >= static_cast<int>(robot.links.size()))
    throw std::invalid_argument("robot " + quote(robot.name) + ": its tip_link is " +
                                std::to_string(robot.tip_link) + ", expected one of its links");
  return forward_kinematics(robot, q)[static_cast<std::size_t>(robot.tip_link)] * robot.link_from_tip;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Robot& robot, const LinkPoses& map_from_link,
                                                  int link, const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, static_cast<Eigen::Index>(robot.dof()));
  for (int i = link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    const Link& mover = robot.links[static_cast<std::size_t>(i)];
    if (mover.joint < 0) continue;
    const Eigen::Isometry3d& pose = map_from_link[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = mover.multiplier * (pose.linear() * axis_of(robot, mover));
    if (kind_of(robot, mover) == JointKind::revolute) {
      columns.col(mover.joint).head<3>() += axis.cross(point - pose.translation());
      columns.col(mover.joint).tail<3>() += axis;
    } else {
      columns.col(mover.joint).head<3>() += axis;
    }
  }
  return columns;
}

void require_configuration(const Robot& robot, const Eigen::VectorXd& q, const std::string& what) {
  const std::string joints = std::to_string(robot.dof());
  if (q.size() != static_cast<Eigen::Index>(robot.dof()))
    throw std::invalid_argument(what + ": expected " + joints + " values, one for each joint of robot " +
                                quote(robot.name) + ", got " + std::to_string(q.size()));
  if (!q.allFinite()) throw std::invalid_argument(what + ": expected " + joints + " finite values");
}

bool moves_tip(const Robot& robot, std::size_t joint) {
  for (int at = robot.tip_link; at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent)
    if (robot.links[static_cast<std::size_t>(at)].joint == static_cast<int>(joint)) return true;
  return false;
}

bool is_same_after_turns(const Robot& robot, std::size_t joint) {
  return robot.joints[joint].kind == JointKind::revolute &&
         std::none_of(robot.links.begin(), robot.links.end(), [&](const Link& link) {
           return link.joint == static_cast<int>(joint) && (kind_of(robot, link) != JointKind::revolute ||
                                                            link.multiplier != std::round(link.multiplier));
         });
}

bool repeats_after_turns(const Robot& robot, std::size_t joint) {
  return is_endless(robot.joints[joint]) && is_same_after_turns(robot, joint);
}

Configuration by_whole_turns(const Robot& robot, Configuration q, const Configuration& near) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const double turns = std::round((near[i] - q[i]) / (2.0 * std::numbers::pi));
    if (turns != 0.0 && repeats_after_turns(robot, j)) q[i] += 2.0 * std::numbers::pi * turns;
  }
  return q;
}

std::string whose_limit(const Robot& robot, std::size_t joint, bool is_upper) {
  const Joint& master = robot.joints[joint];
  const std::string& name = is_upper ? master.upper_follower : master.lower_follower;
  for (const Link& link : robot.links) {
    if (name.empty() || link.joint_name != name || link.joint != static_cast<int>(joint)) continue;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << ", as joint " << quote(name) << " follows " << quote(master.name) << " and ends at "
         << link.multiplier * (is_upper ? master.upper : master.lower) + link.offset
         << (kind_of(robot, link) == JointKind::revolute ? " rad" : " m");
    return text.str();
  }
  return {};
}

std::string limit_violation(const Robot& robot, const Configuration& q) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (q.size() != static_cast<Eigen::Index>(robot.dof())) {
    text << "the configuration has " << q.size() << " values, but " << robot.name << " has " << robot.dof()
         << " joints";
    return text.str();
  }
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const double value = q[static_cast<Eigen::Index>(j)];
    const char* unit = joint.kind == JointKind::revolute ? " rad" : " m";
    if (!std::isfinite(value)) {
      text << "joint " << shortened(joint.name) << " is " << value << ", expected a finite number";
    } else if (value < joint.lower) {
      text << "joint " << shortened(joint.name) << " is " << text_beside(value, joint.lower) << unit
           << ", below its lower limit " << text_beside(joint.lower, value) << unit
           << whose_limit(robot, j, false);
    } else if (value > joint.upper) {
      text << "joint " << shortened(joint.name) << " is " << text_beside(value, joint.upper) << unit
           << ", above its upper limit " << text_beside(joint.upper, value) << unit
           << whose_limit(robot, j, true);
    } else if (std::abs(value) > largest_joint_value) {
      text << "joint " << shortened(joint.name) << " is " << value << unit
           << ", expected at most 1000000 either way of a joint without limits";
    } else {
      continue;
    }
    return text.str();
  }
  return {};
}

}  // namespace clearway
