#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_plan(CLI::App& app, Console& console) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = add_command(app, "plan", "plan one query on a map, in one or several legs", console);
  add_map(*command, options->map, options->cloud_resolution);
  add_robot_flags(*command, options->robot);
  add_survey_flags(*command, options->survey);
  add_attach(*command, options->attach, "");
  add_pick(*command, options->pick, options->place, "; --goal is then an optional configuration to end at");
  command->get_option("--robot")->required(false);
  command
      ->add_option(
          "--start", options->start,
          "start configuration: comma-separated joint values, rad or m, or a state of the SRDF (joints "
          "that it leaves out rest)")
      ->type_name("Q");
  command
      ->add_option(
          "--goal", options->goals,
          "goal configuration, in the same form (joints left out stay); several goals are legs of one path")
      ->type_name("Q")
      ->allow_extra_args(false)
      ->take_all();
  add_goal_poses(*command, options->goal_poses,
                 "; inverse kinematics chooses the free configuration nearest to the start of the leg, and "
                 "others when no path leads there; joints that do not move the tip stay, unless they are in "
                 "the way");
  command->add_flag("--degrees", options->degrees, "--start and --goal in degrees (revolute joints)");
  command->add_option("--planner", options->planner, "see `clearway planners`")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--set", options->settings, "planner option; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag("--print-options", options->print_options,
                    "print the planner's options in effect and exit");
  add_dynamics(*command, options->dynamics, "; default: 0", "; default: 0,0,-9.81");
  add_planning_flags(*command, options->seed, options->time_limit);
  command->add_option("--out", options->out, "write the plan as JSON")->type_name("FILE")->check(file_name);
  command->add_option("--csv", options->csv, "write the waypoints as CSV")
      ->type_name("FILE")
      ->check(file_name);
  command
      ->add_option("--view", options->view,
                   "write an HTML page with map and plan in 3D, over time, with plots")
      ->type_name("FILE.html")
      ->check(file_name);
  command
      ->add_option("--trajectory,--export", options->trajectories,
                   "write the trajectory of a solved and valid plan: ros (JointTrajectory YAML), ros-json, "
                   "urscript, json or csv; repeatable")
      ->type_name("FORMAT FILE")
      ->expected(1)
      ->take_all();
  command->add_flag(
      "--motion", options->motion,
      "add the smooth trajectory to the plan's JSON, where `check` checks it, too; implied by --trajectory");
  const auto add_scale = [&](const char* flag, double& scale, const char* what) {
    command->add_option(flag, scale, what)
        ->check(number("a share from 0.000001 to 1", 1e-6, 1.0))
        ->capture_default_str()
        ->type_name("SHARE");
  };
  add_scale("--speed", options->scales.speed, "scaling of the joints' velocity limits");
  add_scale("--acceleration", options->scales.acceleration, "scaling of their acceleration limits");
  add_scale("--jerk", options->scales.jerk, "scaling of their jerk limits");
  command
      ->add_option("--period", options->period, "time between two points of the trajectory, 0.001 to 0.05 s")
      ->check(number("seconds from 0.001 to 0.05", 0.001, 0.05))
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--grip-time", options->grip_time, "rest where a load is grasped or released, seconds")
      ->check(number("seconds from 0 to 60", 0.0, 60.0))
      ->capture_default_str()
      ->type_name("S");
  return [options](Console& c) {
    if (!options->print_options) {
      for (const auto& [missing, flag] :
           {std::pair{options->map.empty(), "--map"}, std::pair{options->robot.robot.empty(), "--robot"},
            std::pair{options->start.empty(), "--start"},
            std::pair{options->goals.empty() && options->goal_poses.poses.empty() && options->pick.empty(),
                      "--goal"}}) {
        if (missing) throw std::invalid_argument(std::string(flag) + " is required");
      }
    }
    return run_plan(*options, c);
  };
}

}  // namespace clearway
