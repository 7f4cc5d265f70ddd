#include "apps/suites/suite_resolutions.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>

#include "apps/console/parse.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::string name_at(const std::string& name, double resolution) { return name + "-" + to_text(resolution); }

void use_worlds_of(double resolution, Suite& suite, SuiteExperiment& experiment,
                   std::set<std::string>& made) {
  const auto use = [&](std::string& name) {
    if (name.empty()) return;
    const auto found = std::find_if(suite.worlds.begin(), suite.worlds.end(),
                                    [&](const SuiteWorld& world) { return world.name == name; });
    name = name_at(name, resolution);
    if (!made.insert(name).second) return;
    SuiteWorld world = *found;
    world.resolution = resolution;
    world.name = name;
    suite.worlds.push_back(world);
  };
  use(experiment.world);
  for (SuiteProblem& problem : experiment.problems) use(problem.world);
}

SuiteExperiment at_resolution(const SuiteExperiment& experiment, double resolution, Suite& suite,
                              std::set<std::string>& made) {
  SuiteExperiment at = experiment;
  at.resolutions.clear();
  at.name = name_at(experiment.name, resolution);
  at.title += ", voxels of " + significant(1000.0 * resolution) + " mm";
  at.alike = name_at(experiment.name, experiment.resolutions.front());
  if (at.generate) at.generate->resolution = resolution;
  use_worlds_of(resolution, suite, at, made);
  return at;
}

template <typename Part>
void require_names_once(const Suite& suite, const std::vector<Part>& parts, const std::string& what) {
  std::set<std::string> names;
  for (const Part& part : parts)
    if (!names.insert(part.name).second)
      throw std::invalid_argument("suite " + quote(suite.name) + ", field 'resolutions': makes a second " +
                                  what + " " + quote(part.name) + ", expected other names");
}

auto of_planner(const SuitePlanner& planner) {
  return std::tie(planner.label, planner.planner, planner.options);
}

/// What decides the outcome of an experiment with drawn problems, but for the resolution.
bool is_alike(const SuiteExperiment& a, const SuiteExperiment& b) {
  if (!a.generate || !b.generate || a.teams || b.teams) return false;
  const auto terms = [](const SuiteExperiment& e) {
    return std::tie(e.generate->kind, e.generate->count, e.generate->seed, e.robot, e.srdf, e.group, e.fixed,
                    e.packages, e.xacro, e.scale, e.payload, e.policies, e.padding, e.runs, e.time_limit);
  };
  return a.generate->resolution != b.generate->resolution && terms(a) == terms(b) && a.gravity == b.gravity &&
         std::equal(a.planners.begin(), a.planners.end(), b.planners.begin(), b.planners.end(),
                    [](const auto& x, const auto& y) { return of_planner(x) == of_planner(y); });
}

/// Each joins the first that it is alike.
void mark_alike(Suite& suite) {
  for (std::size_t b = 0; b < suite.experiments.size(); ++b) {
    SuiteExperiment& later = suite.experiments[b];
    for (std::size_t a = 0; a < b && later.alike.empty(); ++a) {
      SuiteExperiment& first = suite.experiments[a];
      if (!is_alike(first, later)) continue;
      if (first.alike.empty()) first.alike = first.name;
      later.alike = first.alike;
    }
  }
}

}  // namespace

std::vector<std::string> names_at_resolutions(const SuiteExperiment& experiment) {
  std::vector<std::string> names;
  for (const double resolution : experiment.resolutions)
    names.push_back(name_at(experiment.name, resolution));
  return names;
}

void expand_resolutions(Suite& suite) {
  std::vector<SuiteExperiment> all;
  std::set<std::string> made;
  for (const SuiteExperiment& experiment : suite.experiments) {
    if (experiment.resolutions.empty()) all.push_back(experiment);
    for (const double resolution : experiment.resolutions)
      all.push_back(at_resolution(experiment, resolution, suite, made));
  }
  suite.experiments = std::move(all);
  require_names_once(suite, suite.worlds, "world");
  require_names_once(suite, suite.experiments, "experiment");
  mark_alike(suite);
}

}  // namespace clearway
