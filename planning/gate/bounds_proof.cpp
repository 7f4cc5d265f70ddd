#include "planning/gate/bounds_proof.hpp"

#include <limits>

#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Kinematics of others, which the check has, differ by less.
constexpr double rounding = 1e-6;  ///< metres

/// How far a box reaches into the bounds, along the axis where that is least; negative outside.
double depth(const Eigen::AlignedBox3d& bounds, const Eigen::AlignedBox3d& box) {
  return (bounds.max() - box.min()).cwiseMin(box.max() - bounds.min()).minCoeff();
}

bool is_not_occupied(const ConfigurationSpace& space, const std::string& part) {
  const auto policy = space.policies().find(part);
  return policy == space.policies().end() || policy->second == Policy::not_occupied;
}

Eigen::AlignedBox3d placed_box(const Body& body, const LinkPoses& poses) {
  return body.shape.bounds(poses[static_cast<std::size_t>(body.link)] * body.link_from_shape);
}

}  // namespace

BoundsProof::BoundsProof(const ConfigurationSpace& space, const std::vector<std::string>& allow_outside)
    : bounds_(space.map().bounds()), finest_(space.map().resolution() / 64.0) {
  const Robot& robot = space.robot();
  require_parts(allow_outside, robot, "gate: allow_outside");
  if (!can_be_left(robot, space.map())) return;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    if (!is_policed(robot, body.link) || !is_not_occupied(space, body.part) ||
        is_allowed_outside(body.part, allow_outside) || bounds_.contains(reach_box(robot, body)))
      continue;
    watched_.push_back({i, body_levers(robot, body)});
  }
}

struct BoundsProof::Piece {
  double begin = 0.0, end = 1.0;
};

std::optional<LeavingPart> BoundsProof::leaving(const Robot& robot, const Configuration& from,
                                                const Configuration& to) const {
  if (watched_.empty()) return std::nullopt;
  const Eigen::VectorXd step = to - from, distance = step.cwiseAbs();
  thread_local LinkPoses poses;
  std::vector<Piece> pieces(1);
  while (!pieces.empty()) {
    const Piece piece = pieces.back();
    pieces.pop_back();
    const double middle = (piece.begin + piece.end) / 2.0, half = (piece.end - piece.begin) / 2.0;
    forward_kinematics(robot, from + middle * step, poses);
    bool is_open = false;
    for (const Watched& watched : watched_) {
      const double motion = half * watched.levers.dot(distance);
      if (is_inside(watched, robot, poses, motion + rounding)) continue;
      if (motion <= finest_ || !is_inside(watched, robot, poses, rounding))
        return left(watched, robot, poses, middle);
      is_open = true;
    }
    if (is_open) pieces.insert(pieces.end(), {{middle, piece.end}, {piece.begin, middle}});
  }
  return std::nullopt;
}

/// Some of the box around the body is deeper than `margin` in the bounds.
bool BoundsProof::is_inside(const Watched& watched, const Robot& robot, const LinkPoses& poses,
                            double margin) const {
  return depth(bounds_, placed_box(robot.bodies[watched.body], poses)) > margin;
}

LeavingPart BoundsProof::left(const Watched& watched, const Robot& robot, const LinkPoses& poses,
                              double parameter) const {
  const Body& body = robot.bodies[watched.body];
  const Eigen::AlignedBox3d box = placed_box(body, poses);
  return {body.part,
          bounds_.isEmpty() ? std::numeric_limits<double>::infinity() : bounds_.exteriorDistance(box),
          box.center(),
          {0, parameter}};
}

}  // namespace clearway
