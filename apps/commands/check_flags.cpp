#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {
namespace {

/// What a plan may loosen.
void add_accept_flags(CLI::App& command, std::set<AcceptedTerm>& accepted) {
  const auto accept = [&](const std::string& name, AcceptedTerm term, const std::string& what) {
    command.add_flag_callback(
        "--accept-" + name, [&accepted, term] { accepted.insert(term); }, what);
  };
  accept("robot", AcceptedTerm::robot, "accept a plan for a robot of another name");
  accept("held", AcceptedTerm::held, "accept fixed joints at other values, and another group");
  accept("scale", AcceptedTerm::scale, "accept the plan's scale if it differs");
  accept("base", AcceptedTerm::base, "accept the plan's base pose if it differs");
  accept("policy", AcceptedTerm::policy, "accept the plan's policies if they are looser");
  accept("padding", AcceptedTerm::padding, "accept the plan's padding if it is smaller");
  accept("load", AcceptedTerm::load, "accept the plan's loads and pick if it omits or changes one");
  accept("payload", AcceptedTerm::payload,
         "accept the plan's payload if it is smaller, and its gravity if it differs");
  accept("map", AcceptedTerm::map, "accept a plan made on another map (another SHA-256)");
  accept("goals", AcceptedTerm::goals, "accept a path that starts elsewhere or omits goals");
  accept("moving-start", AcceptedTerm::moving_start,
         "accept a timed trajectory that starts in motion: how the robot comes to its start is not judged");
  accept("moving-end", AcceptedTerm::moving_end,
         "accept a timed trajectory that ends in motion: how the robot stops after it is not judged");
}

}  // namespace

Command add_check(CLI::App& app, Console& console) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = add_command(
      app, "check",
      "check a plan independently and continuously against a stated contract (KDL kinematics, FCL geometry)",
      console);
  command
      ->add_option("plan", options->plan,
                   "plan.json, or a JointTrajectory or DisplayTrajectory of ROS as .json or .yaml, which is "
                   "judged as ROS's "
                   "joint_trajectory_controller runs it if it has times")
      ->required()
      ->type_name("PLAN");
  add_map(*command, options->map, options->cloud_resolution)->required();
  const std::string otherwise = "; default: the map's own query, else ";
  add_robot_flags(*command, options->robot,
                  {.group = "; default: the settings' own, else the plan's",
                   .fixed = "; default: the robot's own, else the plan's",
                   .scale = otherwise + "the robot's own",
                   .base = otherwise + "the plan's",
                   .policy = otherwise + "the plan's, no looser than the map's other queries",
                   .padding = otherwise + "the plan's, at least the robot's position accuracy",
                   .seen_within = otherwise + "the plan's"});
  add_survey_flags(*command, options->survey);
  add_attach(*command, options->attach, otherwise + "the plan's");
  add_pick(*command, options->pick, options->place, "; default: the map's own query; never the plan's");
  add_dynamics(*command, options->dynamics, otherwise + "the plan's", otherwise + "the plan's");
  command
      ->add_option("--grip-time", options->grip_time,
                   "required rest where a load is grasped or released, seconds; default: the plan's")
      ->check(number("seconds from 0 to 60", 0.0, 60.0))
      ->type_name("S");
  add_stops(*command, *options, otherwise + "the plan's",
            "; each goal must be reached by a leg, in this order",
            "; each must be reached by a leg, in this order");
  add_accept_flags(*command, options->accepted);
  return [options](Console& c) { return run_check(*options, c); };
}

}  // namespace clearway
