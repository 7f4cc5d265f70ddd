#include "planning/routes/painted_parts.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "mapping/system/plain_text.hpp"
#include "planning/routes/painted_route.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

std::uint16_t volumes_that_count(const ConfigurationSpace& space, const std::string& part) {
  return part_requirement(space.robot(), space.map(), part, Policy::painted).volumes;
}

/// Numbers of the pieces that hold the point.
std::vector<int> pieces_at(const PaintedGraph& graph, const Eigen::Vector3d& point) {
  std::vector<int> pieces;
  for (const int sphere : graph.holding(point))
    pieces.push_back(graph.piece(static_cast<std::size_t>(sphere)));
  std::sort(pieces.begin(), pieces.end());
  return pieces;
}

/// A point inside of the body: the origin of its own frame, of a hull the middle of its corners.
Eigen::Vector3d middle_of(const Body& body, const LinkPoses& poses) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const std::vector<Eigen::Vector3d>& corners = body.shape.vertices();
  for (const Eigen::Vector3d& corner : corners) middle += corner / static_cast<double>(corners.size());
  return poses[static_cast<std::size_t>(body.link)] * (body.link_from_shape * middle);
}

}  // namespace

std::string parted_volume_sentence(const PlanProblem& problem) {
  const Robot& robot = problem.space.robot();
  const LinkPoses start = forward_kinematics(robot, problem.start);
  const LinkPoses goal = forward_kinematics(robot, problem.goal);
  std::optional<PaintedGraph> graph;  // of the last body
  std::uint16_t volumes_of_graph = 0;
  for (const Body& body : robot.bodies) {
    if (problem.space.policies().at(body.part) != Policy::painted) continue;
    const std::uint16_t volumes = volumes_that_count(problem.space, body.part);
    if (!graph || volumes != volumes_of_graph)
      graph.emplace(problem.space.map(), volumes, 0.0, problem.out_of_time);
    volumes_of_graph = volumes;
    const std::vector<int> from = pieces_at(*graph, middle_of(body, start));
    const std::vector<int> to = pieces_at(*graph, middle_of(body, goal));
    if (from.empty() || to.empty()) continue;  // moved by no joint, or paint that came without its spheres
    const bool share_one = std::find_first_of(from.begin(), from.end(), to.begin(), to.end()) != from.end();
    if (share_one) continue;
    return "the painted volume of the part " + quote(body.part) + " lies in " +
           std::to_string(graph->piece_count()) +
           " pieces that do not overlap, and start and goal are in different ones: paint a way between them";
  }
  return {};
}

}  // namespace clearway
