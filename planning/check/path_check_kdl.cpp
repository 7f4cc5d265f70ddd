#include <algorithm>
#include <kdl/frames.hpp>
#include <kdl/segment.hpp>
#include <map>
#include <numbers>
#include <set>

#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/check/path_check_shape.hpp"

namespace clearway::check {
namespace {

KDL::Vector vector_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame frame_of(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          vector_of(pose.translation())};
}

Eigen::Isometry3d isometry_of(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    pose.translation()[i] = frame.p(i);
    for (int k = 0; k < 3; ++k) pose.linear()(i, k) = frame.M(i, k);
  }
  return pose;
}

/// A link as KDL sees it: a joint about an axis of the parent's frame, then the fixed frame of the link. KDL
/// takes an offset of its own back out of the fixed frame, so mimic factors are applied to the joint's value.
KDL::Segment segment_of(const Robot& robot, const Link& link) {
  const KDL::Frame tip = frame_of(link.parent_from_link);
  if (link.joint < 0) return KDL::Segment(link.name, KDL::Joint(link.name, KDL::Joint::None), tip);
  const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
  const auto kind = kind_of(robot, link) == JointKind::revolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
  return KDL::Segment(link.name, KDL::Joint(joint.name, tip.p, tip.M * vector_of(axis_of(robot, link)), kind),
                      tip);
}

}  // namespace

bool stands(const Robot& robot, const std::string& link) {
  return std::find(robot.standing.begin(), robot.standing.end(), link) != robot.standing.end();
}

KdlModel model_of_robot(const Robot& robot) {
  KdlModel model;
  for (std::size_t i = 0; i < own_links(robot); ++i) {
    const Link& link = robot.links[i];
    model.links.push_back({.segment = std::make_shared<KDL::Segment>(segment_of(robot, link)),
                           .parent = link.parent,
                           .joint = link.joint,
                           .multiplier = link.multiplier,
                           .offset = link.joint < 0 ? 0.0 : link.offset,
                           .is_held = link.is_held,
                           .stands = stands(robot, link.name)});
  }
  for (std::size_t i = 0; i < own_bodies(robot); ++i)
    model.link_from_body.push_back(robot.bodies[i].link_from_shape);
  add_loads(robot, model);
  return model;
}

struct KdlArm::Chains {
  KdlModel model;
  KDL::Frame base;
  std::vector<int> body_link;
  std::vector<KDL::Frame> link_from_body;
  /// For each body and link on its chain: metres a point of the body moves at most per unit of the joint.
  std::vector<std::vector<double>> reach;

  const KdlLink& link(int i) const { return model.links[static_cast<std::size_t>(i)]; }

  /// Sum over the links above `body`, without those that are above `other` too.
  double sum(std::size_t body, int other, const Eigen::VectorXd& abs_dq) const {
    std::vector<bool> shared(model.links.size(), false);
    for (int i = other; i >= 0; i = link(i).parent) shared[static_cast<std::size_t>(i)] = true;
    double total = 0.0;
    for (int i = body_link[body]; i >= 0; i = link(i).parent) {
      const auto at = static_cast<std::size_t>(i);
      if (link(i).joint >= 0 && !shared[at]) total += reach[body][at] * abs_dq[link(i).joint];
    }
    return total;
  }

  /// The links above exactly one of the two bodies: those of `a` upwards, then those of `b`.
  std::vector<int> way_between(std::size_t a, std::size_t b) const {
    std::vector<int> above(model.links.size(), 0);
    for (const std::size_t body : {a, b})
      for (int i = body_link[body]; i >= 0; i = link(i).parent) ++above[static_cast<std::size_t>(i)];
    std::vector<int> way;
    for (const std::size_t body : {a, b})
      for (int i = body_link[body]; i >= 0 && above[static_cast<std::size_t>(i)] == 1; i = link(i).parent)
        way.push_back(i);
    return way;
  }

  std::vector<KDL::Frame> place(const KDL::Frame& root, const Eigen::VectorXd& q) const;
  void place_bodies(const std::vector<KDL::Frame>& frames, BodyPoses& poses) const;

  /// @param farthest from the origin of the body's link to its farthest point
  std::vector<double> reach_of(int body_link_index, double farthest, const std::vector<Joint>& joints) const {
    std::vector<double> result(model.links.size(), 0.0);
    double from_here = farthest;  // from the origin of the link at hand to the body's farthest point
    for (int i = body_link_index; i >= 0; i = link(i).parent) {
      const KdlLink& at = link(i);
      if (at.joint >= 0) {
        const Joint& joint = joints[static_cast<std::size_t>(at.joint)];
        const bool turns = at.segment->getJoint().getType() == KDL::Joint::RotAxis;
        result[static_cast<std::size_t>(i)] = std::abs(at.multiplier) * (turns ? from_here : 1.0);
        if (!turns) {
          from_here += std::abs(at.offset) +
                       std::abs(at.multiplier) * std::max(std::abs(joint.lower), std::abs(joint.upper));
        }
      }
      from_here += at.segment->pose(at.joint < 0 ? at.offset : 0.0).p.Norm();
    }
    return result;
  }
};

KdlArm::KdlArm(const Robot& robot) : chains_(std::make_unique<Chains>()) {
  Chains& chains = *chains_;
  chains.model = robot.source.empty() ? model_of_robot(robot) : model_of_file(robot);
  chains.base = frame_of(robot.map_from_base);
  for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
    const Eigen::Isometry3d& link_from_body = chains.model.link_from_body[b];
    chains.body_link.push_back(robot.bodies[b].link);
    chains.link_from_body.push_back(frame_of(link_from_body));
    chains.reach.push_back(
        chains.reach_of(robot.bodies[b].link,
                        link_from_body.translation().norm() + extent(robot.bodies[b].shape), robot.joints));
  }
}

KdlArm::~KdlArm() = default;

std::vector<KDL::Frame> KdlArm::Chains::place(const KDL::Frame& root, const Eigen::VectorXd& q) const {
  std::vector<KDL::Frame> frames(model.links.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const KdlLink& at = model.links[i];
    frames[i] =
        (at.parent < 0 ? root : frames[static_cast<std::size_t>(at.parent)]) * at.segment->pose(at.value(q));
  }
  return frames;
}

void KdlArm::Chains::place_bodies(const std::vector<KDL::Frame>& frames, BodyPoses& poses) const {
  poses.resize(body_link.size());
  for (std::size_t b = 0; b < poses.size(); ++b)
    poses[b] = isometry_of(frames[static_cast<std::size_t>(body_link[b])] * link_from_body[b]);
}

void KdlArm::place(const Eigen::VectorXd& q, BodyPoses& poses) const {
  chains_->place_bodies(chains_->place(chains_->base, q), poses);
}

Eigen::Isometry3d KdlArm::place(const Eigen::VectorXd& q, std::size_t body) const {
  KDL::Frame frame = chains_->link_from_body[body];
  for (int i = chains_->body_link[body]; i >= 0; i = chains_->link(i).parent)
    frame = chains_->link(i).segment->pose(chains_->link(i).value(q)) * frame;
  return isometry_of(chains_->base * frame);
}

void KdlArm::place_on_base(const Eigen::VectorXd& q, std::vector<Eigen::Isometry3d>& links,
                           BodyPoses& bodies) const {
  const std::vector<KDL::Frame> frames = chains_->place(KDL::Frame::Identity(), q);
  chains_->place_bodies(frames, bodies);
  links.clear();
  for (const KDL::Frame& frame : frames) links.push_back(isometry_of(frame));
}

double KdlArm::motion(std::size_t body, const Eigen::VectorXd& abs_dq) const {
  return chains_->sum(body, -1, abs_dq);
}

double KdlArm::approach(std::size_t a, std::size_t b, const Eigen::VectorXd& abs_dq) const {
  return chains_->sum(a, chains_->body_link[b], abs_dq) + chains_->sum(b, chains_->body_link[a], abs_dq);
}

bool KdlArm::may_touch(std::size_t a, std::size_t b) const {
  const std::vector<int> way = chains_->way_between(a, b);
  return std::any_of(way.begin(), way.end(), [&](int i) {
    const KdlLink& at = chains_->link(i);
    return at.is_held || (at.joint >= 0 && at.multiplier != 0.0);
  });
}

std::string KdlArm::joint_between_links(std::size_t a, std::size_t b) const {
  std::vector<int> above(chains_->model.links.size(), 0);
  for (const std::size_t end : {a, b})
    for (int i = static_cast<int>(end); i >= 0; i = chains_->link(i).parent)
      ++above[static_cast<std::size_t>(i)];
  for (const std::size_t end : {a, b})
    for (int i = static_cast<int>(end); i >= 0 && above[static_cast<std::size_t>(i)] == 1;
         i = chains_->link(i).parent)
      if (const KdlLink& at = chains_->link(i); at.joint >= 0 && at.multiplier != 0.0)
        return at.segment->getJoint().getName();
  return {};
}

const KdlLink* KdlArm::only_joint_between(std::size_t a, std::size_t b) const {
  const KdlLink* found = nullptr;
  for (const int i : chains_->way_between(a, b)) {
    const KdlLink& at = chains_->link(i);
    if (at.joint < 0 && !at.is_held) continue;
    if (found) return nullptr;
    found = &at;
  }
  return found;
}

bool KdlArm::are_neighbours(std::size_t a, std::size_t b) const {
  if (!only_joint_between(a, b)) return false;
  const std::vector<int>& links = chains_->body_link;
  std::vector<int> way = chains_->way_between(a, b);
  way.push_back(chains_->link(way.back()).parent);  // where the ways to the root meet
  return std::none_of(way.begin(), way.end(), [&](int i) {
    return i != links[a] && i != links[b] && std::find(links.begin(), links.end(), i) != links.end();
  });
}

std::vector<int> KdlArm::joints_that_hold(const Robot& robot, const Load& load) const {
  // Of each joint the links that it moves, by the first of them on their way from the root.
  const std::size_t links = chains_->model.links.size();
  std::vector<std::map<int, int>> above(links);  // joint: the link at which it first moves
  for (std::size_t i = 0; i < links; ++i) {      // parents come first
    const KdlLink& at = chains_->model.links[i];
    if (at.parent >= 0) above[i] = above[static_cast<std::size_t>(at.parent)];
    if (at.joint >= 0 && at.multiplier != 0.0) above[i].emplace(at.joint, static_cast<int>(i));
  }
  std::vector<bool> touches(links, false), is_body(links, false);
  std::size_t carrier = links;
  for (std::size_t i = 0; i < links; ++i) {
    const std::string& name = robot.links[i].name;
    if (name == load.link) carrier = i;
    touches[i] =
        name != load.link && std::find(load.touches.begin(), load.touches.end(), name) != load.touches.end();
  }
  for (std::size_t b = 0; b < own_bodies(robot); ++b)
    is_body[static_cast<std::size_t>(chains_->body_link[b])] = true;
  std::vector<int> held;
  if (carrier == links || above[carrier].empty()) return held;
  for (int j = 0; j < static_cast<int>(robot.dof()); ++j) {
    const auto at = [&](std::size_t link) {
      const auto found = above[link].find(j);
      return found == above[link].end() ? -1 : found->second;
    };
    const auto follows = [&](std::size_t link) {  // the carrier, whatever j does
      for (const auto& [joint, first] : above[carrier])
        if (joint != j && !above[link].contains(joint)) return false;
      return true;
    };
    std::set<int> fingers;  // each moved in a way of its own
    bool is_loose = false, moves_more = false;
    for (std::size_t i = 0; i < links; ++i) {
      if (touches[i] || i == carrier) fingers.insert(at(i));
      is_loose |= touches[i] && follows(i) && at(i) != at(carrier);
      moves_more |=
          at(i) >= 0 && (!follows(i) || (at(carrier) >= 0 && is_body[i] && !touches[i] && i != carrier));
    }
    fingers.erase(-1);
    const bool is_wrist = at(static_cast<std::size_t>(robot.tip_link)) >= 0 && fingers.size() < 2;
    if (is_loose && !moves_more && !is_wrist) held.push_back(j);
  }
  return held;
}

std::pair<double, double> KdlArm::range(const Joint& joint, std::size_t number) const {
  double turn = joint.kind == JointKind::revolute ? std::numbers::pi : HUGE_VAL;
  for (const KdlLink& link : chains_->model.links)
    if (link.joint == static_cast<int>(number) && link.multiplier != 0.0 &&
        link.segment->getJoint().getType() == KDL::Joint::RotAxis)
      turn = std::max(turn, std::numbers::pi / std::abs(link.multiplier));
  return {std::isfinite(joint.lower) ? joint.lower : -turn, std::isfinite(joint.upper) ? joint.upper : turn};
}

bool KdlArm::is_policed(std::size_t body) const {
  const bool stands = chains_->link(chains_->body_link[body]).stands;
  for (int i = chains_->body_link[body]; i >= 0; i = chains_->link(i).parent)
    if (chains_->link(i).joint >= 0 || (chains_->link(i).is_held && !stands)) return true;
  return false;
}

}  // namespace clearway::check
