#include "planning/picks/straight_motion.hpp"

#include <algorithm>
#include <cmath>

#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

constexpr double widest_step = 0.2;    ///< rad or m that a joint may move for one step of the tip
constexpr double finest_piece = 1e-6;  ///< m that the body moves at most on a piece that is given up

double lowest(const Robot& robot, const Body& body, const Configuration& q) {
  thread_local LinkPoses poses;
  forward_kinematics(robot, q, poses);
  const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
  const Eigen::Vector3d down = -pose.linear().transpose().col(2);
  return (pose * body.shape.support(down)).z();
}

/// One piece of an edge, and how high the body is at its ends.
struct EdgePart {
  Configuration from, to;
  double height_from = 0.0, height_to = 0.0;
};

/// In steps of one length.
std::optional<std::vector<Configuration>> stepped(const Robot& robot, const Configuration& from,
                                                  const Eigen::Vector3d& way, double step) {
  const IkOptions options{.max_iterations = 100, .restarts = 0};
  const Eigen::Isometry3d begin = tip_pose(robot, from);
  const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / step - 1e-9)));
  std::vector<Configuration> path = {from};
  for (int i = 1; i <= steps; ++i) {
    const Eigen::Isometry3d pose = Eigen::Translation3d(way * i / steps) * begin;
    auto next = inverse_kinematics(robot, pose, path.back(), options);
    if (!next || !((*next - path.back()).lpNorm<Eigen::Infinity>() <= widest_step)) return std::nullopt;
    path.push_back(std::move(*next));
  }
  return path;
}

}  // namespace

std::optional<std::vector<Configuration>> straight_motion(const Robot& robot, const Configuration& from,
                                                          const Eigen::Vector3d& way, double step) {
  for (const double finer : {1.0, 4.0})  // near a singularity joints are quick
    if (auto path = stepped(robot, from, way, step / finer)) return path;
  return std::nullopt;
}

bool is_path_free(const ConfigurationSpace& space, const std::vector<Configuration>& path) {
  if (path.empty() || !space.is_free(path.front()) || !space.is_free(path.back())) return false;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (!space.is_edge_free(path[i], path[i + 1])) return false;
  return true;
}

bool keeps_height(const Robot& robot, std::size_t index, const std::vector<Configuration>& path, double low,
                  double high) {
  const Body& body = robot.bodies[index];
  const Eigen::VectorXd levers = body_levers(robot, body) * (1.0 + 1e-9);
  std::vector<EdgePart> open;
  for (std::size_t i = path.size(); i-- > 1;)
    open.push_back({path[i - 1], path[i], lowest(robot, body, path[i - 1]), lowest(robot, body, path[i])});
  if (path.size() == 1)
    open.push_back({path[0], path[0], lowest(robot, body, path[0]), lowest(robot, body, path[0])});
  while (!open.empty()) {
    const EdgePart piece = open.back();
    open.pop_back();
    const double below = std::min(piece.height_from, piece.height_to);
    const double above = std::max(piece.height_from, piece.height_to);
    if (!(below >= low && above <= high)) return false;
    // From either end the body moves no farther than half the way of a piece.
    const double moved = levers.dot((piece.to - piece.from).cwiseAbs()) / 2.0;
    if (below - moved >= low && above + moved <= high) continue;
    if (!(moved > finest_piece)) return false;
    const Configuration middle = 0.5 * (piece.from + piece.to);
    const double height = lowest(robot, body, middle);
    open.push_back({middle, piece.to, height, piece.height_to});
    open.push_back({piece.from, middle, piece.height_from, height});
  }
  return true;
}

}  // namespace clearway
