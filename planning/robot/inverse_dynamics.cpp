#include "planning/robot/inverse_dynamics.hpp"

#include "mapping/system/plain_text.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// A link in the map frame: how it moves, and what its parent does to it, about its origin.
struct LinkMotion {
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();  ///< angular velocity
  Eigen::Vector3d turning_rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d rise = Eigen::Vector3d::Zero();  ///< acceleration of the origin, gravity's taken off
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
};

Eigen::Vector3d axis_in_map(const Robot& robot, const Link& link, const Eigen::Isometry3d& pose) {
  return pose.linear() * axis_of(robot, link);
}

/// From the parent outwards.
LinkMotion moved_link(const Robot& robot, const Link& link, const LinkMotion& parent,
                      const Eigen::Isometry3d& from, const Eigen::Isometry3d& pose,
                      const Eigen::VectorXd& velocity, const Eigen::VectorXd& acceleration) {
  LinkMotion motion = parent;
  const Eigen::Vector3d arm = pose.translation() - from.translation();
  motion.force = motion.moment = Eigen::Vector3d::Zero();
  motion.rise += parent.turning_rate.cross(arm) + parent.turning.cross(parent.turning.cross(arm));
  if (link.joint < 0) return motion;
  const Eigen::Vector3d axis = axis_in_map(robot, link, pose);
  const double rate = link.multiplier * velocity[link.joint];
  const double change = link.multiplier * acceleration[link.joint];
  if (kind_of(robot, link) == JointKind::revolute) {
    motion.turning += rate * axis;
    motion.turning_rate += change * axis + rate * parent.turning.cross(axis);
  } else {
    motion.rise += change * axis + 2.0 * rate * parent.turning.cross(axis);
  }
  return motion;
}

/// What makes a mass at `arm` from the link's origin, with an inertia about its centre, move with the link.
void add_mass(LinkMotion& motion, double mass, const Eigen::Vector3d& arm, const Eigen::Matrix3d& inertia) {
  const Eigen::Vector3d force =
      mass * (motion.rise + motion.turning_rate.cross(arm) + motion.turning.cross(motion.turning.cross(arm)));
  motion.force += force;
  motion.moment +=
      arm.cross(force) + inertia * motion.turning_rate + motion.turning.cross(inertia * motion.turning);
}

/// Whether a single joint moves the link, which turns it about the direction of gravity.
bool turns_upright(const Robot& robot, const LinkPoses& poses, std::size_t link,
                   const Eigen::Vector3d& gravity) {
  int joints = 0;
  bool is_upright = false;
  for (int at = static_cast<int>(link); at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent) {
    const Link& moved = robot.links[static_cast<std::size_t>(at)];
    if (moved.joint < 0) continue;
    const Eigen::Vector3d axis = axis_in_map(robot, moved, poses[static_cast<std::size_t>(at)]);
    is_upright =
        kind_of(robot, moved) == JointKind::revolute && axis.cross(gravity).norm() <= 1e-9 * gravity.norm();
    ++joints;
  }
  return joints == 1 && is_upright;
}

/// Links with bodies of the robot's own that have no mass, nor a link that is fixed to them.
std::vector<bool> weightless_links(const Robot& robot, const Eigen::Vector3d& gravity) {
  std::vector<std::size_t> rigid(robot.links.size());  // the topmost link that it is fixed to
  std::vector<double> mass(robot.links.size(), 0.0);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const bool is_fixed = link.parent >= 0 && link.joint < 0 && !link.is_held;
    rigid[i] = is_fixed ? rigid[static_cast<std::size_t>(link.parent)] : i;
    mass[rigid[i]] += link.mass;
  }
  const LinkPoses poses =
      forward_kinematics(robot, Configuration::Zero(static_cast<Eigen::Index>(robot.dof())));
  std::vector<bool> weightless(robot.links.size(), false);
  for (std::size_t k = 0; k + robot.loads.size() < robot.bodies.size(); ++k) {
    const auto link = static_cast<std::size_t>(robot.bodies[k].link);
    weightless[link] = !(mass[rigid[link]] > 0.0) && !turns_upright(robot, poses, link, gravity);
  }
  return weightless;
}

}  // namespace

Eigen::VectorXd joint_torques(const Robot& robot, const Configuration& q, const Eigen::VectorXd& velocity,
                              const Eigen::VectorXd& acceleration, const TorqueTerms& terms) {
  const LinkPoses poses = forward_kinematics(robot, q);
  std::vector<LinkMotion> motions(robot.links.size());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    if (link.parent < 0) {
      motions[i].rise = -terms.load.gravity;
    } else {
      const auto parent = static_cast<std::size_t>(link.parent);
      motions[i] = moved_link(robot, link, motions[parent], poses[parent], poses[i], velocity, acceleration);
    }
    const Eigen::Matrix3d turn = poses[i].linear();
    add_mass(motions[i], link.mass, turn * link.center_of_mass, turn * terms.inertia[i] * turn.transpose());
    if (static_cast<int>(i) == robot.tip_link)
      add_mass(motions[i], terms.load.payload, turn * robot.link_from_tip.translation(),
               Eigen::Matrix3d::Zero());
  }
  Eigen::VectorXd torques = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t i = robot.links.size(); i-- > 0;) {
    const Link& link = robot.links[i];
    const LinkMotion& motion = motions[i];
    if (link.joint >= 0) {
      const bool turns = kind_of(robot, link) == JointKind::revolute;
      torques[link.joint] +=
          link.multiplier * axis_in_map(robot, link, poses[i]).dot(turns ? motion.moment : motion.force);
    }
    if (link.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(link.parent);
    motions[parent].force += motion.force;
    motions[parent].moment +=
        motion.moment + (poses[i].translation() - poses[parent].translation()).cross(motion.force);
  }
  return torques;
}

std::vector<bool> moves_mass(const Robot& robot, const JointLoad& load) {
  std::vector<bool> moves(robot.dof(), false);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const bool is_loaded = load.payload > 0.0 && static_cast<int>(i) == robot.tip_link;
    if (!is_loaded && !(robot.links[i].mass > 0.0)) continue;
    for (int at = static_cast<int>(i); at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent) {
      const int joint = robot.links[static_cast<std::size_t>(at)].joint;
      if (joint >= 0) moves[static_cast<std::size_t>(joint)] = true;
    }
  }
  return moves;
}

std::vector<std::string> links_without_mass(const Robot& robot, const Eigen::Vector3d& gravity) {
  const std::vector<bool> is_weightless = weightless_links(robot, gravity);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (is_weightless[i] && is_moved(robot, static_cast<int>(i))) names.push_back(robot.links[i].name);
  return names;
}

std::string missing_masses(const Robot& robot, const Eigen::Vector3d& gravity) {
  const std::vector<std::string> links = links_without_mass(robot, gravity);
  if (links.empty()) return {};
  std::string others;
  if (links.size() > 1)
    others = " and " + std::to_string(links.size() - 1) + (links.size() == 2 ? " other" : " others") +
             " that move";
  return "The robot's file gives link " + quote(links.front()) + others + " no mass (<inertial>)";
}

}  // namespace clearway
