#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {
namespace {

void add_files(CLI::App& command, PlanOptions& options) {
  add_file(command, "--out", options.out, "write the plan as JSON", "FILE");
  add_file(command, "--csv", options.csv, "write the waypoints as CSV", "FILE");
  add_file(command, "--view", options.view,
           "write an HTML page with map and plan in 3D, over time, with plots", "FILE.html");
}

/// Trajectories, and what they are like.
void add_motion_flags(CLI::App& command, PlanOptions& options) {
  command
      .add_option("--trajectory,--export", options.trajectories,
                  "write the trajectory of a solved and valid plan: ros (JointTrajectory YAML), ros-json, "
                  "urscript, json or csv; repeatable")
      ->type_name("FORMAT FILE")
      ->expected(1)
      ->take_all();
  command.add_flag(
      "--motion", options.motion,
      "add the smooth trajectory to the plan's JSON, where `check` checks it, too; implied by --trajectory");
  const auto add_scale = [&](const char* flag, double& scale, const char* what) {
    command.add_option(flag, scale, what)
        ->check(number("a share from 0.000001 to 1", 1e-6, 1.0))
        ->capture_default_str()
        ->type_name("SHARE");
  };
  add_scale("--speed", options.scales.speed, "scaling of the joints' velocity limits");
  add_scale("--acceleration", options.scales.acceleration, "scaling of their acceleration limits");
  add_scale("--jerk", options.scales.jerk, "scaling of their jerk limits");
  command
      .add_option("--period", options.period, "time between two points of the trajectory, 0.001 to 0.05 s")
      ->check(number("seconds from 0.001 to 0.05", 0.001, 0.05))
      ->capture_default_str()
      ->type_name("S");
  command.add_option("--grip-time", options.grip_time, "rest where a load is grasped or released, seconds")
      ->check(number("seconds from 0 to 60", 0.0, 60.0))
      ->capture_default_str()
      ->type_name("S");
}

void require_query(const PlanOptions& options) {
  const bool has_goal = !options.goals.empty() || !options.goal_poses.poses.empty() || !options.pick.empty();
  for (const auto& [is_given, flag] :
       {std::pair{!options.map.empty(), "--map"}, std::pair{!options.robot.robot.empty(), "--robot"},
        std::pair{!options.start.empty(), "--start"}, std::pair{has_goal, "--goal"}})
    if (!is_given) throw std::invalid_argument(std::string(flag) + " is required");
}

}  // namespace

Command add_plan(CLI::App& app, Console& console) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = add_command(app, "plan", "plan one query on a map, in one or several legs", console);
  add_map(*command, options->map, options->cloud_resolution);
  add_robot_flags(*command, options->robot);
  add_survey_flags(*command, options->survey);
  add_attach(*command, options->attach, "");
  add_pick(*command, options->pick, options->place, "; --goal is then an optional configuration to end at");
  command->get_option("--robot")->required(false);
  add_stops(*command, *options, " (joints that it leaves out rest)",
            " (joints left out stay); several goals are legs of one path",
            "; inverse kinematics chooses the free configuration nearest to the start of the leg, and "
            "others when no path leads there; joints that do not move the tip stay, unless they are in "
            "the way");
  command->add_option("--planner", options->planner, "see `clearway planners`")
      ->capture_default_str()
      ->type_name("NAME");
  add_repeatable(*command, "--set", options->settings, "planner option; repeatable", "KEY=VALUE");
  command->add_flag("--print-options", options->print_options,
                    "print the planner's options in effect and exit");
  add_dynamics(*command, options->dynamics, "; default: 0", "; default: 0,0,-9.81");
  add_planning_flags(*command, options->seed, options->time_limit);
  add_files(*command, *options);
  add_motion_flags(*command, *options);
  return [options](Console& c) {
    if (!options->print_options) require_query(*options);
    return run_plan(*options, c);
  };
}

}  // namespace clearway
