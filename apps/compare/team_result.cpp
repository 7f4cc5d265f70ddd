#include "apps/compare/team_result.hpp"

#include <algorithm>
#include <limits>

#include "apps/console/parse.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {
namespace {

/// Where an obstacle outran a robot, distances from obstacles do not count, and robots that it drove together
/// need only not touch. Contact is never safe, however far a step may come below d_s. A run that the clock
/// ended kept its distances so far, which is not called safe.
std::string check_word(const TeamRun& run, const TeamVerdict& verdict,
                       const TeamCircumstances& circumstances) {
  const double least = run.figures.security_distance - run.step_bound();
  const bool keeps =
      verdict.least_separation >= least - circumstances.unseen_motion && verdict.between_robots >= least;
  if (verdict.greatest_speed_share > 1.0 + 1e-6 || !verdict.robots_are_apart) return "refused";
  if (!run.outrun.empty()) return "outrun";
  if (!verdict.is_apart || !keeps) return "refused";
  return circumstances.is_cut_short ? "unfinished" : "valid";
}

std::string contact_of(const TeamVerdict& verdict) {
  if (!verdict.contact.empty()) return verdict.contact;
  return verdict.between + " came within " + significant(1000.0 * verdict.least_separation) + " mm at " +
         significant(verdict.time, 4) + " s";
}

/// Figures of the whole team that have columns of their own.
std::map<std::string, double> statistics_of(const TeamRun& run) {
  const std::vector<double>& steps = run.figures.max_step;
  return {{"influence_distance_m", run.figures.influence_distance},
          {"security_distance_m", run.figures.security_distance},
          {"xi_m", run.figures.xi},
          {"max_step", *std::max_element(steps.begin(), steps.end())},
          {"least_separation_m", run.least_separation()}};
}

/// Those of one robot, to be added up.
std::map<std::string, double> statistics_of(const TeamTrace& trace) {
  const auto along = std::count(trace.along_boundary.begin(), trace.along_boundary.end(), true);
  return {{"steps_local", static_cast<double>(trace.along_boundary.size()) - static_cast<double>(along)},
          {"steps_boundary", static_cast<double>(along)},
          {"deadlocks", trace.deadlocks},
          {"constraint_switches", trace.switches},
          {"steps_relaxed", trace.relaxed},
          {"steps_shortened", trace.shortened},
          {"steps_over_acceleration", trace.accelerated}};
}

/// J of one robot's way; not a number where its file gives links no mass.
double cost_of(const Robot& robot, std::size_t index, const TeamCircumstances& circumstances,
               const std::vector<Configuration>& way) {
  if (!missing_masses(robot, circumstances.gravity).empty()) return std::numeric_limits<double>::quiet_NaN();
  return PathCost(
      robot, {.gravity = robot.map_from_base.linear().transpose() * circumstances.gravity,
              .payload_mass = circumstances.payloads.empty() ? 0.0 : circumstances.payloads[index]})(way);
}

CompareTeamRun figures_of(const TeamRun& run, const TeamVerdict& verdict, double unseen) {
  CompareTeamRun figures;
  figures.security_distance = run.figures.security_distance;
  figures.step_bound = run.step_bound() + unseen;
  figures.obstacle_speed = run.figures.greatest_obstacle_speed;
  figures.between_robots = verdict.between_robots;
  figures.outrun = run.outrun;
  return figures;
}

}  // namespace

CompareRun team_result(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                       const TeamCircumstances& circumstances) {
  CompareRun found;
  found.status = run.status;
  found.explanation = run.explanation;
  found.team = figures_of(run, verdict, circumstances.unseen_motion);
  if (run.steps() == 0) return found;
  found.motion = {static_cast<double>(run.steps()) * run.period, verdict.greatest_speed_share,
                  verdict.greatest_acceleration_share};
  found.statistics = statistics_of(run);
  found.check = check_word(run, verdict, circumstances);
  if (found.check == "refused") found.contact = contact_of(verdict);
  found.legs = run.status == PlanStatus::solved ? 1 : 0;
  found.steps = run.steps();
  found.waypoints = run.steps() + 1;
  found.min_clearance = verdict.least_separation;
  for (std::size_t i = 0; i < run.traces.size(); ++i) {
    found.length += joint_space_length(run.traces[i].positions);
    found.cost += cost_of(team.robots[i].space->robot(), i, circumstances, run.traces[i].positions);
    for (const auto& [name, value] : statistics_of(run.traces[i])) found.statistics[name] += value;
  }
  return found;
}

}  // namespace clearway
