#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_gate(CLI::App& app, Console& console) {
  auto options = std::make_shared<GateCommandOptions>();
  CLI::App* command = add_command(
      app, "gate", "prove or refuse timed chunks of motion from other programs: JSON lines in and out",
      console);
  command->footer(
      "Each line on stdin holds 2 to 64 configurations, joined by straight joint-space edges:\n"
      "  {\"id\": \"pick-7\", \"times\": [0, 0.1], \"positions\": [[0, 0.5], [0, 0.6]]}\n"
      "Each gets one line on stdout: line, id, passed, reason, sentence; of a refusal, where there is one, "
      "the first unproved piece\n(proved_share: of it from its begin), body, other, voxel (center; state; "
      "blocks_as; last_seen_s; history where the map\nkeeps it); may_go: how far the arm may go all the same "
      "(until_s, its position there, where it stands_at after braking).\nA chunk passes if its motion and "
      "the braking after it are proved free, with the\nloads of --attach. It must start where the last "
      "passed chunk ends, or where the robot has stopped after it;\nwith \"leaves_at\": 8, at configuration "
      "8 "
      "of that chunk, whose rest is then not run. \"joints\": [\"elbow\", …] names the\njoints in the order "
      "of "
      "the positions; without it, it is that of `clearway robots ROBOT`. Wherever the robot was\nmoved by "
      "other means, {\"restart\": [0, 0.5]} says where it stands (null: anywhere); its answer has "
      "`restarted`.\n"
      "Times of one chunk are not compared with those of another: whoever runs them starts one when the last "
      "has ended, at\nleaves_at, or when the robot stands. The map is read once; start gate anew for "
      "another.\n"
      "Exit status: 0 all chunks passed, 1 some were refused, 2 bad input.");
  add_map(*command, options->map, options->cloud_resolution)->required();
  add_robot_flags(*command, options->robot);
  add_attach(*command, options->attach, "; legs are not allowed here");
  add_allow_outside(*command, options->allow_outside);
  command
      ->add_option(
          "--start", options->start,
          "configuration before the first chunk, comma-separated, rad or m; default: where that chunk starts")
      ->type_name("Q");
  const auto add_limit = [&](const char* flag, std::vector<double>& values, const char* text,
                             const char* type) {
    command->add_option(flag, values, text)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(positive())
        ->type_name(type);
  };
  add_limit("--max-velocity", options->max_velocity,
            "velocity limit of all joints, or one per joint, rad/s or m/s; default: the robot's own, else 1",
            "V");
  add_limit("--deceleration", options->deceleration,
            "braking deceleration of all joints, or one per joint, rad/s^2 or m/s^2; at most a joint's own "
            "acceleration limit, where it has one; default: 5",
            "A");
  command
      ->add_option("--reaction", options->reaction,
                   "reaction time at the last velocity before the robot brakes, seconds; default: 0")
      ->check(number("a time from 0 to 60 (seconds)", 0.0, 60.0))
      ->type_name("S");
  command
      ->add_option("--tolerance", options->tolerance,
                   "tolerance of a chunk's start per joint, rad or m; default: 0.001")
      ->check(number("a number from 0 to 1 (rad or m)", 0.0, 1.0))
      ->type_name("M");
  command
      ->add_option("--max-age", options->max_age,
                   "refuse a chunk whose first time is more than S seconds from the map's newest "
                   "observation; both must use the same clock")
      ->check(positive())
      ->type_name("S");
  command
      ->add_option("--max-duration", options->max_duration,
                   "refuse a chunk that lasts longer, seconds; default: 60")
      ->check(positive())
      ->type_name("S");
  command
      ->add_option("--max-line", options->max_line, "maximum length of an input line, bytes; default: 262144")
      ->check(number("a whole number from 64 to 100000000 (bytes)", 64, 1e8))
      ->type_name("BYTES");
  return [options](Console& c) { return run_gate(*options, c); };
}

}  // namespace clearway
