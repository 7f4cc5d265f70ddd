#include <algorithm>
#include <kdl/frames.hpp>
#include <kdl/segment.hpp>

#include "planning/path_check_model.hpp"

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
  const auto kind = joint.kind == JointKind::revolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
  return KDL::Segment(link.name, KDL::Joint(joint.name, tip.p, tip.M * vector_of(joint.axis), kind), tip);
}

/// Distance of the body's farthest point from the origin of its link.
double extent(const Body& body) {
  double farthest = body.shape.radius() + body.shape.length() / 2;
  if (body.shape.kind() == Shape::Kind::box) farthest = body.shape.edges().norm() / 2;
  if (body.shape.kind() == Shape::Kind::convex) {
    farthest = 0.0;
    for (const Eigen::Vector3d& v : body.shape.vertices()) farthest = std::max(farthest, v.norm());
  }
  return body.link_from_shape.translation().norm() + farthest;
}

}  // namespace

struct KdlArm::Chains {
  std::vector<KDL::Segment> segments;  ///< one for each link, parents first
  std::vector<int> parent, joint;      ///< of each link
  std::vector<double> multiplier, offset;
  KDL::Frame base;
  std::vector<int> body_link;
  std::vector<KDL::Frame> link_from_body;
  /// For each body and link on its chain: metres a point of the body moves at most per unit of the joint.
  std::vector<std::vector<double>> reach;

  /// Sum over the links above `body`, without those that are above `other` too.
  double sum(std::size_t body, int other, const Eigen::VectorXd& abs_dq) const {
    std::vector<bool> shared(segments.size(), false);
    for (int i = other; i >= 0; i = parent[static_cast<std::size_t>(i)])
      shared[static_cast<std::size_t>(i)] = true;
    double total = 0.0;
    for (int i = body_link[body]; i >= 0; i = parent[static_cast<std::size_t>(i)]) {
      const auto link = static_cast<std::size_t>(i);
      if (joint[link] >= 0 && !shared[link]) total += reach[body][link] * abs_dq[joint[link]];
    }
    return total;
  }
};

KdlArm::KdlArm(const Robot& robot) : chains_(std::make_unique<Chains>()) {
  Chains& chains = *chains_;
  chains.base = frame_of(robot.map_from_base);
  for (const Link& link : robot.links) {
    chains.segments.push_back(segment_of(robot, link));
    chains.parent.push_back(link.parent);
    chains.joint.push_back(link.joint);
    chains.multiplier.push_back(link.multiplier);
    chains.offset.push_back(link.offset);
  }
  for (const Body& body : robot.bodies) {
    chains.body_link.push_back(body.link);
    chains.link_from_body.push_back(frame_of(body.link_from_shape));
    std::vector<double> reach(robot.links.size(), 0.0);
    double from_here = extent(body);  // from the origin of the link at hand to the body's farthest point
    for (int i = body.link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
      const Link& link = robot.links[static_cast<std::size_t>(i)];
      if (link.joint >= 0) {
        const Joint& joint = robot.joints[static_cast<std::size_t>(link.joint)];
        const bool turns = joint.kind == JointKind::revolute;
        reach[static_cast<std::size_t>(i)] = std::abs(link.multiplier) * (turns ? from_here : 1.0);
        if (!turns) {
          from_here += std::abs(link.offset) +
                       std::abs(link.multiplier) * std::max(std::abs(joint.lower), std::abs(joint.upper));
        }
      }
      from_here += link.parent_from_link.translation().norm();
    }
    chains.reach.push_back(std::move(reach));
  }
}

KdlArm::~KdlArm() = default;

void KdlArm::place(const Eigen::VectorXd& q, BodyPoses& poses) const {
  std::vector<KDL::Frame> frames(chains_->segments.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int parent = chains_->parent[i], joint = chains_->joint[i];
    const KDL::Frame& map_from_parent = parent < 0 ? chains_->base : frames[static_cast<std::size_t>(parent)];
    const double value = joint < 0 ? 0.0 : chains_->multiplier[i] * q[joint] + chains_->offset[i];
    frames[i] = map_from_parent * chains_->segments[i].pose(value);
  }
  poses.resize(chains_->body_link.size());
  for (std::size_t b = 0; b < poses.size(); ++b) {
    poses[b] =
        isometry_of(frames[static_cast<std::size_t>(chains_->body_link[b])] * chains_->link_from_body[b]);
  }
}

double KdlArm::motion(std::size_t body, const Eigen::VectorXd& abs_dq) const {
  return chains_->sum(body, -1, abs_dq);
}

double KdlArm::approach(std::size_t a, std::size_t b, const Eigen::VectorXd& abs_dq) const {
  return chains_->sum(a, chains_->body_link[b], abs_dq) + chains_->sum(b, chains_->body_link[a], abs_dq);
}

bool KdlArm::is_moved(std::size_t body) const {
  for (int i = chains_->body_link[body]; i >= 0; i = chains_->parent[static_cast<std::size_t>(i)]) {
    if (chains_->joint[static_cast<std::size_t>(i)] >= 0) return true;
  }
  return false;
}

}  // namespace clearway::check
