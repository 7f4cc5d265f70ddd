#include "planning/beam/beam_guided.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planning/beam/beam.hpp"
#include "planning/beam/via_beam.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/routes/painted_parts.hpp"
#include "planning/routes/route_guide.hpp"
#include "planning/sampling/sampled_trees.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

using Path = std::vector<Configuration>;

constexpr double patience = 4.0;  ///< neighbours that a leg of the beam looks at for each head it may keep

/// What a search found and what it asked.
struct Found {
  Path path;  ///< empty: nothing
  std::uint64_t configurations = 0, edges = 0;
};

/// Steps of the lattice: `stride` of the robot's own, but never more than a joint can move.
std::vector<double> strides(const Robot& robot, double stride) {
  std::vector<double> steps;
  for (const Joint& joint : robot.joints) {
    const bool turns = joint.kind == JointKind::revolute;
    const double own = joint.step > 0.0 ? joint.step : turns ? 0.008726646259971648 : 0.005 * robot.scale;
    const double range = joint.upper - joint.lower;  // 0: it stands, whatever its step
    steps.push_back(range > 0.0 ? std::min(stride * own, range) : stride * own);
  }
  return steps;
}

/// One leg of the beam to exactly `to`, while it goes well: in at most half as many steps again as the
/// straight way takes, and while few neighbours are refused.
Found beam_leg(const PlanProblem& problem, const Configuration& from, const Configuration& to, int width,
               const std::vector<double>& steps) {
  double ramp = 0.0;
  for (std::size_t j = 0; j < steps.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    ramp = std::max(ramp, std::abs(to[i] - from[i]) / steps[j]);
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  if (*least < 1e-6 || *most > 10.0) return {};  // no lattice: a joint that does not move
  const Beam beam(
      {.width = width, .step = steps, .max_steps = static_cast<int>(std::min(1.5 * ramp, 1e6)) + 4});
  // Asked once for each group of neighbours at one distance.
  double groups = patience * width * (ramp + 4.0);
  const auto gives_up = [&] { return --groups < 0.0 || problem.out_of_time(); };
  const PlanResult leg = beam.plan({problem.space, problem.cost, from, to, problem.seed, gives_up});
  Found found{{}, leg.configurations_checked, leg.edges_checked};
  if (leg.status == PlanStatus::solved && leg.waypoints.back() == to) found.path = leg.waypoints;
  return found;
}

/// Steps 2 to 5: routes, via regions and trees.
class GuidedSearch {
 public:
  GuidedSearch(const PlanProblem& problem, const Eigen::VectorXd& weight, PlanResult& result)
      : problem_(problem), weight_(weight), result_(result), hand_(find_end_effector(problem.space)) {}

  const EndEffectorRoute& route() {
    if (!looked_) first_route_ = find_end_effector_route(problem_, hand_);
    looked_ = true;
    return first_route_;
  }

  /// The beam through the via regions of one route after the other; each avoids where the last one ended.
  Path through_regions(int routes, const ViaBeamOptions& options) {
    std::vector<Sphere> avoided;
    for (int attempt = 0; attempt < routes && !problem_.out_of_time(); ++attempt) {
      const EndEffectorRoute next =
          attempt == 0 ? route() : find_end_effector_route(problem_, hand_, avoided);
      if (next.points.empty()) break;
      ViaPath via = search_via_regions(problem_, hand_, next, weight_, options);
      count(via.configurations, via.edges);
      result_.statistics["via_regions"] = static_cast<double>(via.regions);
      result_.statistics["routes"] += 1.0;
      if (!via.waypoints.empty()) {
        result_.explanation = "Led to the goal through " + std::to_string(via.regions) + " via regions.";
        return std::move(via.waypoints);
      }
      if (via.farthest.size() > result_.explored.size()) result_.explored = std::move(via.farthest);
      if (via.reached == via.regions) break;
      avoided.push_back({via.stopped_at, 2.0 * hand_.outer_radius});
    }
    return {};
  }

  std::string failure() const {
    if (!looked_) return "Out of time before a route for the hand was looked for.";
    return first_route_.points.empty()
               ? "There is no way for the hand's middle, and no path was found without one."
               : "No path was found along the hand's routes.";
  }

  /// Corner points of a rough path by two trees that the route guides.
  Path through_trees(TreeOptions options, double guided_share) {
    if (problem_.out_of_time()) return {};
    options.find_guide = [&] { return guide_along(problem_, hand_, route(), guided_share); };
    const TreePath rough = connect_trees(problem_, options);
    count(rough.configurations, rough.edges);
    result_.statistics["samples"] += rough.samples;
    if (rough.waypoints.empty()) return {};
    result_.explanation = "Led to the goal by two guided trees.";
    return rough.waypoints;
  }

 private:
  void count(std::uint64_t configurations, std::uint64_t edges) {
    result_.configurations_checked += configurations;
    result_.edges_checked += edges;
  }

  const PlanProblem& problem_;
  const Eigen::VectorXd& weight_;
  PlanResult& result_;
  EndEffector hand_;
  EndEffectorRoute first_route_;
  bool looked_ = false;
};

}  // namespace

BeamGuidedOptions read_options(OptionReader& reader, BeamGuidedOptions initial) {
  return {.width = reader.integer("width", initial.width, 1, 100000),
          .stride = reader.number("stride", initial.stride, 1.0, 100.0),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000),
          .guided_share = reader.number("guided_share", initial.guided_share, 0.0, 1.0),
          .range = reader.number_or_auto("range", initial.range, 0.0, 1e3),
          .routes = reader.integer("routes", initial.routes, 0, 100),
          .attempts = reader.integer("attempts", initial.attempts, 0, 1000000),
          .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6)};
}

BeamGuided::BeamGuided(const BeamGuidedOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult BeamGuided::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  result.statistics["deadline_hit"] = 0.0;
  const Eigen::VectorXd weight = joint_weights(problem.space, options_.prismatic_scale);
  const std::vector<double> steps = strides(problem.space.robot(), options_.stride);
  Path path;
  ++result.edges_checked;
  if (problem.space.is_edge_free(problem.start, problem.goal)) {
    path = {problem.start, problem.goal};
    result.explanation = "The straight way is free.";
  }
  if (path.empty()) {
    if (std::string parted = parted_volume_sentence(problem); !parted.empty()) {
      parted.front() = 'T';
      result.status = PlanStatus::no_path;
      result.final_distance = (problem.goal - problem.start).norm();
      result.explanation = parted + ".";
      return result;
    }
    Found direct = beam_leg(problem, problem.start, problem.goal, options_.width, steps);
    result.configurations_checked += direct.configurations;
    result.edges_checked += direct.edges;
    path = std::move(direct.path);
    if (!path.empty()) result.explanation = "The beam reached the goal without a guide.";
  }
  if (path.empty()) path = guided(problem, weight, result);
  if (path.empty()) return result;
  path =
      straightened(problem, std::move(path), weight, {.attempts = options_.attempts}, result.edges_checked);
  result.status = PlanStatus::solved;
  result.explored.clear();
  result.statistics["deadline_hit"] = problem.out_of_time() ? 1.0 : 0.0;
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, weight, AnyAngleOptions().cost_step);
  result.waypoints = std::move(path);
  return result;
}

std::vector<Configuration> BeamGuided::guided(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                              PlanResult& result) const {
  GuidedSearch search(problem, weight, result);
  TreeOptions trees{
      .weight = weight, .range = options_.range, .max_samples = std::min(300, options_.max_samples)};
  Path path = search.through_regions(1, {.effort = 1, .halvings = 0});
  if (path.empty()) path = search.through_trees(trees, options_.guided_share);
  if (path.empty()) path = search.through_regions(options_.routes, {});
  trees.max_samples = options_.max_samples;
  if (path.empty() && !problem.out_of_time()) path = search.through_trees(trees, options_.guided_share);
  if (!path.empty() && is_certified(problem.space, path, result.edges_checked)) return path;
  const bool out_of_time = problem.out_of_time();
  result.status = out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
  result.statistics["deadline_hit"] = out_of_time ? 1.0 : 0.0;
  if (result.explored.empty()) result.explored = {problem.start};
  result.final_distance = (problem.goal - result.explored.back()).norm();
  result.explanation = path.empty() ? search.failure() : "The path found could not be certified free.";
  return {};
}

}  // namespace clearway
