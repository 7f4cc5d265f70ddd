#include "planning/sampling/ompl_planners.hpp"

#include <ompl/base/Planner.h>

#include "planning/problem/option_reader.hpp"
#include "planning/sampling/ompl_algorithm.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

// The ranges that several of the planners share.

double read_range(OptionReader& reader, double initial) {
  return reader.number_or_auto("range", initial, 0.0, 1e3);
}
double read_prismatic_scale(OptionReader& reader, double initial) {
  return reader.number_or_auto("prismatic_scale", initial, 0.0, 1e6);
}
int read_max_samples(OptionReader& reader, int initial) {
  return reader.integer("max_samples", initial, 1, 100000000);
}
int read_shortcuts(OptionReader& reader, int initial) {
  return reader.integer("shortcuts", initial, 0, 1000000);
}

}  // namespace

RrtConnectOmplOptions read_options(OptionReader& reader, RrtConnectOmplOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .simplify = reader.flag("simplify", initial.simplify)};
}

EstOptions read_options(OptionReader& reader, EstOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

PrmOptions read_options(OptionReader& reader, PrmOptions initial) {
  return {.prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

RrtStarOptions read_options(OptionReader& reader, RrtStarOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

BitStarOptions read_options(OptionReader& reader, BitStarOptions initial) {
  return {.batch = reader.integer("batch", initial.batch, 1, 1000000),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

OmplPlanner::OmplPlanner(std::string_view name, PlannerOptions in_force, const Settings& settings)
    : Planner(name, std::move(in_force)), settings_(settings) {}

RrtConnectOmpl::RrtConnectOmpl(const RrtConnectOmplOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = OmplAlgorithm::rrtconnect,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .simplify = options.simplify}) {}

Est::Est(const EstOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = OmplAlgorithm::est,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

Prm::Prm(const PrmOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = OmplAlgorithm::prm,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

RrtStar::RrtStar(const RrtStarOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = OmplAlgorithm::rrtstar,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

BitStar::BitStar(const BitStarOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = OmplAlgorithm::bitstar,
                   .batch = options.batch,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

PlanResult OmplPlanner::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  OmplQuery query{
      problem, joint_weights(problem.space, settings_.prismatic_scale), std::mt19937_64(problem.seed), {}};
  if (problem.start == problem.goal)  // there is nothing to improve on
    return result_of(problem, ends, {.waypoints = {problem.start, problem.goal}}, query.weight, 0);
  const auto information = certified_space(query);
  const auto definition = problem_definition(query, information);
  TreePath found;
  bool has_path = false;
  definition->setIntermediateSolutionCallback([&](const ompl::base::Planner*,
                                                  const std::vector<const ompl::base::State*>&,
                                                  ompl::base::Cost) { has_path = true; });
  const bool improves = improves_path(settings_.algorithm);
  const std::function<bool()> is_over = [&] {
    found.out_of_time = problem.out_of_time();
    return found.out_of_time || (query.samples >= settings_.max_samples && (has_path || !improves));
  };
  const auto planner =
      make_algorithm({.algorithm = settings_.algorithm, .range = settings_.range, .batch = settings_.batch},
                     query, information, definition, is_over);
  planner->solve(ompl::base::PlannerTerminationCondition(is_over));
  if (settings_.simplify) simplify(query, information, *definition);
  found.waypoints = waypoints(query, *definition);
  found.samples = query.samples;
  found.configurations = query.configurations;
  found.edges = query.edges;
  return result_of(problem, ends, std::move(found), query.weight, settings_.shortcuts);
}

}  // namespace clearway
