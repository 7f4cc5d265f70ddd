#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_robots(CLI::App& app, Console& console) {
  auto options = std::make_shared<RobotsOptions>();
  CLI::App* command = add_command(
      app, "robots", "list the robots that come with the program, or describe what it makes of one", console);
  const std::vector<CLI::Option*> of_all = command->get_options();
  CLI::Option* robot =
      command
          ->add_option("robot", options->robot.robot,
                       "name, .yaml, .urdf or .xacro file: print its joints, bodies, tip and "
                       "states as plan and check have them; default: list those that come "
                       "with the program")
          ->type_name("ROBOT");
  add_group_flags(*command, options->robot);
  add_place_flags(*command, options->robot);
  add_attach(*command, options->attach, "");
  command
      ->add_option("--at", options->at,
                   "configuration at which bodies and tip are told, or a state of the SRDF; default: all "
                   "joints at 0, or at the limit nearest to it")
      ->type_name("Q");
  command->add_flag("--degrees", options->degrees, "--at in degrees (revolute joints)");
  add_file(*command, "--view", options->view, "write an HTML page with the robot in 3D and these tables",
           "FILE.html");
  for (CLI::Option* option : command->get_options())
    if (option != robot && std::find(of_all.begin(), of_all.end(), option) == of_all.end())
      option->needs(robot);
  return [options](Console& c) { return run_robots(*options, c); };
}

}  // namespace clearway
