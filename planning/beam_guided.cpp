#include "planning/beam_guided.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planning/any_angle.hpp"
#include "planning/beam.hpp"
#include "planning/joint_weights.hpp"
#include "planning/option_reader.hpp"
#include "planning/route_guide.hpp"
#include "planning/sampled_trees.hpp"
#include "planning/shortcut.hpp"
#include "planning/via_beam.hpp"

namespace clearway {
namespace {

using Path = std::vector<Configuration>;

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
    steps.push_back(std::min(stride * own, joint.upper - joint.lower));
  }
  return steps;
}

/// One leg of the beam to exactly `to`, in at most twice the steps that the straight way takes.
Found beam_leg(const PlanProblem& problem, const Configuration& from, const Configuration& to, int width,
               const std::vector<double>& steps) {
  double ramp = 0.0;
  for (std::size_t j = 0; j < steps.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    ramp = std::max(ramp, std::abs(to[i] - from[i]) / steps[j]);
  }
  const Beam beam({{"width", std::to_string(width)},
                   {"step", to_text(steps)},
                   {"max_steps", std::to_string(static_cast<int>(1.5 * ramp) + 4)}});
  const PlanResult leg =
      beam.plan({problem.space, problem.cost, from, to, problem.seed, problem.out_of_time});
  Found found{{}, leg.configurations_checked, leg.edges_checked};
  if (leg.status == PlanStatus::solved && leg.waypoints.back() == to) found.path = leg.waypoints;
  return found;
}

void add(Path& path, const Path& piece) {
  for (const Configuration& q : piece) {
    if (path.empty() || q != path.back()) path.push_back(q);
  }
}

}  // namespace

BeamGuided::BeamGuided(const PlannerOptions& options) {
  OptionReader reader("beam_guided", options);
  width_ = reader.integer("width", 3, 1, 100000);
  stride_ = reader.number("stride", 6.0, 1.0, 100.0);
  max_samples_ = reader.integer("max_samples", 20000, 1, 100000000);
  guided_share_ = reader.number("guided_share", 0.5, 0.0, 1.0);
  range_ = reader.number_or_auto("range", 0.0, 1e3);
  routes_ = reader.integer("routes", 4, 0, 100);
  attempts_ = reader.integer("attempts", 100, 0, 1000000);
  prismatic_scale_ = reader.number_or_auto("prismatic_scale", 0.0, 1e6);
  reader.refuse_unknown();
  in_force_ = reader.in_force();
}

PlanResult BeamGuided::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  const Eigen::VectorXd weight = joint_weights(problem.space, prismatic_scale_);
  const std::vector<double> steps = strides(problem.space.robot(), stride_);
  Path path;
  ++result.edges_checked;
  if (problem.space.is_edge_free(problem.start, problem.goal)) {
    path = {problem.start, problem.goal};
    result.explanation = "The straight way is free.";
  }
  if (path.empty()) {
    Found direct = beam_leg(problem, problem.start, problem.goal, width_, steps);
    result.configurations_checked += direct.configurations;
    result.edges_checked += direct.edges;
    path = std::move(direct.path);
    if (!path.empty()) result.explanation = "The beam reached the goal without a guide.";
  }
  if (path.empty()) path = guided(problem, weight, steps, result);
  if (path.empty()) return result;
  path = straightened(problem, std::move(path), weight, {.attempts = attempts_}, result.edges_checked);
  result.status = PlanStatus::solved;
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = problem.cost(path);
  result.waypoints = std::move(path);
  return result;
}

std::vector<Configuration> BeamGuided::guided(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                              const std::vector<double>& steps, PlanResult& result) const {
  const Hand hand = find_hand(problem.space);
  HandRoute route;
  std::vector<Sphere> avoided;
  for (int attempt = 0; attempt < routes_; ++attempt) {
    HandRoute next = find_hand_route(problem, hand, avoided);
    if (next.points.empty()) break;
    const ViaPath via = search_via_regions(problem, hand, next, weight, {});
    result.configurations_checked += via.configurations;
    result.edges_checked += via.edges;
    result.statistics["routes"] = attempt + 1;
    result.statistics["via_regions"] = static_cast<double>(via.regions);
    result.statistics["reached"] = static_cast<double>(via.reached);
    if (!via.waypoints.empty()) {
      result.explanation = "via beam";
      return via.waypoints;
    }
    if (attempt == 0) route = std::move(next);
    if (via.reached == via.regions) break;
    avoided.push_back({via.stopped_at, 2.0 * hand.outer_radius});
  }
  const std::size_t regions = route.points.size();
  TreeOptions options{.weight = weight, .range = range_, .max_samples = max_samples_};
  if (regions > 0) options.guide = RouteGuide(problem, hand, std::move(route), guided_share_);
  const TreePath rough = connect_trees(problem, options);
  result.configurations_checked += rough.configurations;
  result.edges_checked += rough.edges;
  result.statistics["samples"] = rough.samples;
  if (rough.waypoints.empty()) {
    result.status = rough.out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
    result.final_distance = (problem.goal - problem.start).norm();
    result.explanation = "No rough path to guide the beam was found with " + std::to_string(rough.samples) +
                         " samples" + (regions > 0 ? "." : "; there is no way for the hand's middle either.");
    return {};
  }
  const Path corners = shortcut(problem.space, rough.waypoints, weight, problem.seed, 30);
  Path path;
  int stood_in = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    Found leg = beam_leg(problem, corners[i - 1], corners[i], width_, steps);
    result.configurations_checked += leg.configurations;
    result.edges_checked += leg.edges;
    if (leg.path.empty()) {
      ++stood_in;
      ++result.edges_checked;
      if (!problem.space.is_edge_free(corners[i - 1], corners[i])) {
        result.status = PlanStatus::no_path;
        result.explanation = "The rough path found could not be certified free.";
        return {};
      }
      leg.path = {corners[i - 1], corners[i]};
    }
    add(path, leg.path);
  }
  result.statistics["via_goals"] = static_cast<double>(corners.size() - 2);
  result.statistics["straight_legs"] = stood_in;
  result.explanation = "Led to the goal by " + std::to_string(corners.size() - 2) + " via goals.";
  return path;
}

}  // namespace clearway
