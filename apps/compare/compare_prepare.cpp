#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>

#include "apps/compare/compare_run.hpp"
#include "apps/compare/compare_team.hpp"
#include "apps/compare/external_planner.hpp"
#include "apps/query/query.hpp"
#include "apps/suites/sensed_spaces.hpp"
#include "apps/suites/suite_teams.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse(const Suite& suite, const SuiteExperiment& experiment, const std::string& what) {
  throw std::invalid_argument("suite '" + suite.name + "', experiment '" + experiment.name + "', " + what);
}

/// Does what may throw a sentence, and puts before it where it happened.
template <typename Work>
auto reported(const Suite& suite, const SuiteExperiment& experiment, const std::string& where,
              const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    refuse(suite, experiment, where + ": " + error.what());
  }
}

/// Plots of the page beyond those that every experiment has.
const std::vector<std::string> plot_names = {"profiles", "cost_against_width", "share_against_width",
                                             "animation"};

/// Everything that plans promises certified paths, but for those who say that they look here and there.
bool promises_certified_paths(const std::string& planner, const PlannerOptions& in_force) {
  const auto nodes = in_force.find("node_only");
  const auto& table = planner_table();
  const auto entry =
      std::find_if(table.begin(), table.end(), [&](const auto& e) { return e.name == planner; });
  return (entry == table.end() || entry->certifies) && (nodes == in_force.end() || nodes->second != "true");
}

void require_plots(const Suite& suite, const SuiteExperiment& experiment) {
  for (const std::string& plot : experiment.plots) {
    if (experiment.teams && plot != "animation")
      refuse(suite, experiment, "field 'plots': teams have no '" + plot + "': expected animation");
    if (std::find(plot_names.begin(), plot_names.end(), plot) != plot_names.end()) continue;
    refuse(suite, experiment,
           "field 'plots': unknown plot " + quote(plot) + ": " + suggestion(plot, plot_names));
  }
}

/// Every robot of every team that is written out can be made and led; every part that a policy names exists.
void require_teams(const Suite& suite, const SuiteExperiment& experiment,
                   const std::vector<TeamOptions>& leaders) {
  const Snapshot nothing = empty_map();
  std::set<std::string> parts = {"default"};
  for (const SuiteTeam& given : experiment.teams->teams) {
    const Team team = reported(suite, experiment, "field 'teams'", [&] {
      Team made = make_team(given, nothing, {});
      for (const TeamOptions& leader : leaders) check_team_inputs(made, leader);
      return made;
    });
    if (experiment.teams->sensing)
      reported(suite, experiment, "field 'sensing', team '" + given.name + "'",
               [&] { check_sensors(*experiment.teams->sensing, team); });
    for (const TeamRobot& robot : team.robots)
      for (const Body& body : robot.space->robot().bodies) parts.insert(body.part);
  }
  for (const auto& [part, policy] : experiment.policies)
    if (!experiment.generate && !parts.contains(part))
      refuse(suite, experiment, "field 'policies': no robot of its teams has a part '" + part + "'");
}

bool is_chosen(const SuitePlanner& planner, const std::vector<std::string>& only) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& name) {
           return name == planner.label || name == planner.planner;
         });
}

void add_externals(const Suite& suite, const std::vector<ExternalChoice>& externals,
                   const std::vector<std::string>& only, std::set<std::string>& labels,
                   PreparedExperiment& ready) {
  const std::string name(ExternalPlanner::planner_name);
  for (const ExternalChoice& external : externals) {
    auto made = std::make_unique<ExternalPlanner>(external.command);
    if (!labels.insert(external.label).second)
      refuse(suite, ready.setup, "--external: it has a planner '" + external.label + "' already");
    if (!is_chosen({external.label, name, {}}, only)) continue;
    ready.planners.push_back({external.label, name, made->options(), false});
    ready.makers.push_back(std::move(made));
  }
}

}  // namespace

PreparedExperiment prepare(const Suite& suite, const SuiteExperiment& experiment,
                           const std::vector<std::string>& only,
                           const std::vector<ExternalChoice>& externals) {
  PreparedExperiment ready;
  ready.setup = experiment;
  const double usual_limit = experiment.teams ? std::numeric_limits<double>::infinity() : suite.time_limit;
  ready.time_limit = experiment.time_limit.value_or(usual_limit);
  if (!experiment.teams) {
    ready.robot = reported(suite, experiment, "field 'robot'", [&] {
      Robot robot = load_robot(RobotRequest{experiment.robot, experiment.srdf, experiment.group,
                                            experiment.fixed, experiment.packages, experiment.xacro});
      if (experiment.scale) robot = scaled(robot, *experiment.scale / robot.scale);
      if (experiment.map_from_base) robot.map_from_base = *experiment.map_from_base;
      return robot;
    });
    ready.policies = suite_policies(suite, experiment, ready.robot);
    ready.setup.padding = experiment.padding.value_or(ready.robot.position_accuracy);
  }
  require_plots(suite, experiment);
  std::set<std::string> labels;
  for (const SuitePlanner& planner : experiment.planners) {
    const std::string where = "planner '" + planner.label + "'";
    auto made =
        reported(suite, experiment, where, [&] { return make_planner(planner.planner, planner.options); });
    if (!labels.insert(planner.label).second) {
      refuse(suite, experiment, "field 'planners': the label '" + planner.label + "' is given twice");
    }
    if (!is_chosen(planner, only)) continue;
    ready.planners.push_back({planner.label, planner.planner, made->options(),
                              promises_certified_paths(planner.planner, made->options())});
    if (experiment.teams) {
      ready.leaders.push_back(reported(suite, experiment, where, [&] {
        TeamOptions options = team_options(planner.planner, planner.options);
        options.period = experiment.teams->period;
        options.duration = experiment.teams->duration;
        options.max_acceleration = experiment.teams->max_acceleration;
        return options;
      }));
    } else {
      ready.makers.push_back(std::move(made));
    }
  }
  if (!experiment.teams) {
    add_externals(suite, externals, only, labels, ready);
    return ready;
  }
  require_teams(suite, experiment, ready.leaders);
  ready.map = reported(suite, experiment, "field 'world'", [&] { return team_map(suite, experiment); });
  if (experiment.teams->sensing) {
    reported(suite, experiment, "field 'sensing'",
             [&] { check_sensors(*experiment.teams->sensing, *ready.map); });
  }
  return ready;
}

}  // namespace clearway
