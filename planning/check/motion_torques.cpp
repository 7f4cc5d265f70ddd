#include "planning/check/motion_torques.hpp"

#include <algorithm>
#include <cmath>
#include <kdl/tree.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include <limits>
#include <locale>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_links.hpp"

namespace clearway {
namespace {

constexpr double most_held = 0.95;        ///< share of a limit that gravity may take unnamed
constexpr double most_slowed_for = 0.99;  ///< share of a limit beyond which motions are not slowed
constexpr double longest_sample = 0.008;  ///< seconds

KDL::Vector kdl_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// The robot as a KDL tree with masses.
class MassTree {
 public:
  MassTree(const Robot& robot, const TorqueTerms& terms)
      : model_(check::model_of_robot(robot)), tree_("robot base") {
    for (std::size_t i = 0; i < robot.links.size(); ++i) add(robot, terms, i);
    const JointLoad& load = terms.load;
    if (load.payload > 0.0 && !robot.links.empty()) {
      const Eigen::Vector3d tip = robot.link_from_tip.translation();
      const KDL::Segment point("payload of the tip", KDL::Joint("payload of the tip", KDL::Joint::None),
                               KDL::Frame(kdl_vector(tip)),
                               KDL::RigidBodyInertia(load.payload, KDL::Vector::Zero()));
      tree_.addSegment(point, name(static_cast<std::size_t>(robot.tip_link)));
    }
    const Eigen::Vector3d gravity = robot.map_from_base.linear().transpose() * load.gravity;
    solver_ = std::make_unique<KDL::TreeIdSolver_RNE>(tree_, kdl_vector(gravity));
  }

  Eigen::VectorXd torques(const Eigen::VectorXd& q, const Eigen::VectorXd& velocity,
                          const Eigen::VectorXd& acceleration) {
    const auto count = static_cast<unsigned>(moved_.size());
    KDL::JntArray position(count), rate(count), change(count), result(count);
    for (unsigned k = 0; k < count; ++k) {
      const check::KdlLink& link = model_.links[moved_[k]];
      position(k) = link.value(q);
      rate(k) = link.multiplier * velocity[link.joint];
      change(k) = link.multiplier * acceleration[link.joint];
    }
    if (solver_->CartToJnt(position, rate, change, {}, result) < 0)
      throw std::runtime_error("KDL's inverse dynamics refuses the robot");
    Eigen::VectorXd torques = Eigen::VectorXd::Zero(q.size());
    for (unsigned k = 0; k < count; ++k) {
      const check::KdlLink& link = model_.links[moved_[k]];
      torques[link.joint] += link.multiplier * result(k);
    }
    return torques;
  }

 private:
  static std::string name(std::size_t link) { return "link " + std::to_string(link); }

  void add(const Robot& robot, const TorqueTerms& terms, std::size_t i) {
    const Link& link = robot.links[i];
    const KDL::Segment& moved = *model_.links[i].segment;
    const Eigen::Matrix3d& about = terms.inertia[i];
    const KDL::RigidBodyInertia mass(
        link.mass, kdl_vector(link.center_of_mass),
        KDL::RotationalInertia(about(0, 0), about(1, 1), about(2, 2), about(0, 1), about(0, 2), about(1, 2)));
    const KDL::Segment segment(name(i), moved.getJoint(), moved.getFrameToTip(), mass);
    const int parent = model_.links[i].parent;
    tree_.addSegment(segment, parent < 0 ? "robot base" : name(static_cast<std::size_t>(parent)));
    if (model_.links[i].joint >= 0) moved_.push_back(i);
  }

  check::KdlModel model_;
  KDL::Tree tree_;
  std::unique_ptr<KDL::TreeIdSolver_RNE> solver_;
  std::vector<std::size_t> moved_;  ///< the link of each of the tree's joints
};

/// Keeps the greatest share of a limit among moments.
class Greatest {
 public:
  Greatest(const Robot& robot, const TorqueTerms& terms)
      : robot_(robot), limits_(terms.limits), rest_(Eigen::VectorXd::Zero(limits_.size())), held_(rest_) {
    if ((limits_.array() < std::numeric_limits<double>::infinity()).any()) tree_.emplace(robot, terms);
  }

  void add(double place, const MotionState& state) {
    if (!tree_) return;
    const Eigen::VectorXd held = tree_->torques(state.position, rest_, rest_);
    const Eigen::VectorXd torques = tree_->torques(state.position, state.velocity, state.acceleration);
    for (Eigen::Index j = 0; j < limits_.size(); ++j) {
      const double by_gravity = std::abs(held[j]) / limits_[j];
      if (!(by_gravity <= held_[j]) && !std::isnan(held_[j])) held_[j] = by_gravity;
      const double share = std::abs(torques[j]) / limits_[j];
      if (share <= found_.share || std::isnan(found_.share)) continue;  // what is no number is kept
      found_.share = share;
      found_.torque = torques[j];
      found_.place = place;
      found_.joint = j;
    }
  }

  TorqueFinding found() {
    for (Eigen::Index j = 0; j < held_.size(); ++j)
      if (!(held_[j] <= most_held))
        found_.overloaded.push_back(robot_.joints[static_cast<std::size_t>(j)].name);
    if (held_.size() > 0) found_.held = held_[found_.joint];
    return found_;
  }

 private:
  const Robot& robot_;
  const Eigen::VectorXd& limits_;
  Eigen::VectorXd rest_;
  Eigen::VectorXd held_;  ///< the greatest share of each joint's limit that gravity takes
  std::optional<MassTree> tree_;
  TorqueFinding found_;
};

/// Moments of a motion: all knots, and so many between them that none is farther from the next than 8 ms.
template <typename Visit>
void visit_samples(const Motion& motion, const Visit& visit) {
  const int pieces = std::max(1, static_cast<int>(std::ceil(motion.period / longest_sample - 1e-9)));
  for (std::size_t k = 0; k < motion.positions.size(); ++k) {
    const auto begin = static_cast<double>(k);
    visit(begin, {motion.positions[k], motion.velocities[k], motion.accelerations[k], {}});
    for (int i = 1; k + 1 < motion.positions.size() && i < pieces; ++i) {
      const double place = begin + static_cast<double>(i) / pieces;
      visit(place, motion.at(motion.period * place));
    }
  }
}

}  // namespace

Eigen::VectorXd kdl_torques(const Robot& robot, const Configuration& q, const Eigen::VectorXd& velocity,
                            const Eigen::VectorXd& acceleration, const TorqueTerms& terms) {
  return MassTree(robot, terms).torques(q, velocity, acceleration);
}

TorqueFinding greatest_torques(const Robot& robot, const Motion& motion, const TorqueTerms& terms) {
  Greatest greatest(robot, terms);
  visit_samples(motion, [&](double place, const MotionState& state) { greatest.add(place, state); });
  return greatest.found();
}

TorqueFinding greatest_torques(const Robot& robot, const std::vector<std::pair<double, MotionState>>& moments,
                               const TorqueTerms& terms) {
  Greatest greatest(robot, terms);
  for (const auto& [time, state] : moments) greatest.add(time, state);
  return greatest.found();
}

std::string torque_fault(const Robot& robot, double period, const TorqueTerms& terms,
                         const TorqueFinding& found, double excess) {
  if (found.share <= 1.0 + excess) return {};
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "motion: after " << period * found.place << " s the torque of joint "
       << shortened(robot.joints[static_cast<std::size_t>(found.joint)].name) << " is " << found.torque
       << ", beyond its limit of " << terms.limits[found.joint] << ", the URDF's effort";
  if (found.held > 1.0)
    text << ", and gravity alone takes more than all of it: no slower motion helps (an effort of 0 states no "
            "limit, where "
            "this one is a placeholder)";
  else if (found.held > most_slowed_for)
    text << ", of which gravity alone takes " << 100.0 * found.held
         << " % at its worst: motions are not slowed where it takes more than 99 %";
  return text.str();
}

}  // namespace clearway
