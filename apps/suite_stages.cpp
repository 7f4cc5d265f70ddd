#include "apps/suite_stages.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/suite_world.hpp"
#include "mapping/map_digest.hpp"
#include "mapping/map_file.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse(const Suite& suite, const SuiteExperiment& experiment, const std::string& what) {
  throw std::invalid_argument("suite '" + suite.name + "', experiment '" + experiment.name + "', " + what);
}

const SuiteWorld& world_of(const Suite& suite, const SuiteExperiment& experiment) {
  const auto found = std::find_if(suite.worlds.begin(), suite.worlds.end(),
                                  [&](const SuiteWorld& world) { return world.name == experiment.world; });
  if (found == suite.worlds.end()) {
    refuse(suite, experiment,
           "field 'world': expected the name of one of the worlds, got '" + experiment.world + "'");
  }
  return *found;
}

Configuration configuration(const std::vector<double>& values) {
  return Eigen::Map<const Configuration>(values.data(), static_cast<Eigen::Index>(values.size()));
}

StageProblem stage_problem(const SuiteProblem& problem) {
  StageProblem ready{problem.name, configuration(problem.start), {}};
  for (const auto& goal : problem.goals) ready.goals.push_back(configuration(goal));
  return ready;
}

void require_sizes(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  const auto check = [&](const SuiteProblem& problem, const std::vector<double>& q, const char* field) {
    if (q.size() == robot.dof()) return;
    refuse(suite, experiment,
           "problem '" + problem.name + "', field '" + field + "': got " + std::to_string(q.size()) +
               " values, expected " + std::to_string(robot.dof()) + " (robot '" + robot.name + "')");
  };
  for (const SuiteProblem& problem : experiment.problems) {
    check(problem, problem.start, "start");
    for (const auto& goal : problem.goals) check(problem, goal, "goals");
  }
}

}  // namespace

Policies suite_policies(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  Policies policies;
  for (const auto& [part, policy] : experiment.policies) {
    if (part == "default") {
      policies.other = parse_policy(policy);
      policies.critical_by_default = false;
      continue;
    }
    if (std::none_of(robot.bodies.begin(), robot.bodies.end(),
                     [&](const Body& body) { return body.part == part; })) {
      refuse(suite, experiment, "field 'policies': robot '" + robot.name + "' has no part '" + part + "'");
    }
    policies.parts[part] = parse_policy(policy);
  }
  return policies;
}

SuiteStages::SuiteStages(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot)
    : suite_(suite), experiment_(experiment), robot_(robot) {
  static_cast<void>(suite_policies(suite, experiment, robot));
  world_of(suite, experiment);
  require_sizes(suite, experiment, robot);
}

std::size_t SuiteStages::size() const { return 1; }

SuiteStage SuiteStages::make(std::size_t) const {
  const SuiteWorld& world = world_of(suite_, experiment_);
  SuiteStage stage;
  stage.world = world.name;
  if (world.map.empty()) {
    stage.map = make_map(world, robot_.critical_parts);
    stage.digest = map_sha256(stage.map);
  } else {
    stage.map = load_map(world.map);
    stage.map_file = world.map.string();
    stage.digest = map_sha256(world.map);
  }
  for (const SuiteProblem& problem : experiment_.problems) stage.problems.push_back(stage_problem(problem));
  return stage;
}

}  // namespace clearway
