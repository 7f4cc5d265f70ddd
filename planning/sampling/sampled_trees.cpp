#include "planning/sampling/sampled_trees.hpp"

#include <algorithm>
#include <limits>

#include "mapping/system/number_text.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/path/path_origins.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/path/shortcut.hpp"
#include "planning/routes/route_guide.hpp"
#include "planning/sampling/bidirectional_trees.hpp"

namespace clearway {

TreeGuide guide_along(const PlanProblem& problem, const EndEffector& hand, const EndEffectorRoute& route,
                      double share) {
  if (route.points.size() < 2 || share <= 0.0) return {};
  constexpr double walked = 5.0 / 6.0;
  const double walk_share = walked * share;
  return {RouteGuide(problem, hand, route, (share - walk_share) / (1.0 - walk_share)),
          std::make_shared<RouteWalk>(problem.space.robot(), hand, route), walk_share};
}

TreePath connect_trees(const PlanProblem& problem, const TreeOptions& options) {
  BidirectionalTrees trees(problem, options.weight, options.range);
  std::mt19937_64 random(problem.seed);
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  if (!trees.join(BidirectionalTrees::start, 0, everywhere, 1)) {
    TreeGuide guide;
    const int unguided =
        options.find_guide ? std::min(options.unguided_samples, options.max_samples) : options.max_samples;
    if (!trees.grow(unguided, random, guide) && unguided < options.max_samples && !problem.out_of_time()) {
      guide = options.find_guide();
      trees.grow(options.max_samples - unguided, random, guide);
    }
  }
  TreePath result;
  if (trees.is_joined()) {
    result.waypoints = trees.path();
    result.origins = trees.path_origins();
  }
  result.out_of_time = !trees.is_joined() && problem.out_of_time();
  result.is_certified = trees.is_joined();
  result.samples = trees.samples();
  result.reach = trees.reach();
  result.edges = trees.edges_checked();
  return result;
}

PlanResult result_of(const PlanProblem& problem, const PlanResult& ends, TreePath found,
                     const Eigen::VectorXd& weight, int shortcuts) {
  PlanResult result = ends;
  std::vector<Configuration> path = found.waypoints;
  if (!path.empty())
    path = shortcut(problem.space, std::move(path), weight, problem.seed, shortcuts, problem.out_of_time);
  result.configurations_checked += found.configurations;
  result.edges_checked = found.edges;
  result.statistics = {{"samples", found.samples}};
  const bool is_proved =
      !path.empty() && (found.is_certified || is_certified(problem.space, path, result.edges_checked));
  if (!is_proved) {
    result.status = found.out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
    result.final_distance = (problem.goal - problem.start).norm();
    result.explanation = path.empty()
                             ? "No path found with " + counted(found.samples, "sample") + ". " + found.reach
                             : "The path found could not be certified free.";
    return result;
  }
  result.explanation = "Joined start and goal with " + counted(found.samples, "sample") + ".";
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, weight, AnyAngleOptions().cost_step);
  result.origins = origins_after(found.waypoints, found.origins, path);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
