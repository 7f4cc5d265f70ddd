#include "apps/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <ostream>
#include <stdexcept>

#include "apps/commands/manual.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/failure.hpp"
#include "apps/console/flags.hpp"
#include "mapping/system/nearest_name.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

namespace {

/// What a flag writes instead of running a command.
struct Text {
  std::string text;
};

/// "did you mean": the nearest candidate, if it is near.
std::string meant(const std::string& word, std::vector<std::string> candidates) {
  std::erase_if(candidates, [&](const std::string& c) { return edit_distance(word, c) >= c.size(); });
  return nearest_name(word, candidates, 3);
}

/// What a recording's map is like.
void add_map_flags(CLI::App& command, double& resolution, std::string& integration, int& threads) {
  command.add_option("--resolution", resolution, "edge of a voxel, metres; default: the setup's, else 0.02")
      ->check(number("a number from 0.0001 to 100", 1e-4, 100.0))
      ->type_name("M");
  command
      .add_option("--integration", integration,
                  "how scans free space: safe (no voxel next to a surface), or compatible (with OctoMap); "
                  "default: the setup's, else safe")
      ->check([](const std::string& text) {
        return text == "safe" || text == "compatible" ? std::string{}
                                                      : "expected safe or compatible, got '" + text + "'";
      })
      ->type_name("MODE");
  command
      .add_option(
          "--threads", threads,
          "threads for images and scans; the map does not depend on it; default: all cores, at most 8")
      ->check(number("a whole number from 1 to 64", 1, 64))
      ->type_name("N");
}

Command add_replay(CLI::App& app, Console& console) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = add_command(
      app, "replay", "turn a recording into painted spheres, a fused map, plans and a report page", console);
  add_source(*command, options->recording, options->camera_seconds, "recording",
             "MRPT rawlog; ROS bag (.bag, .mcap); video; .pcd, .ply, .png or .jpg: a file, or a folder of "
             "them; folder of depth pictures");
  command
      ->add_option("--setup", options->setup,
                   "tag boards, probe, robot and queries, by file or name; default: the recording's own")
      ->type_name("SETUP.yaml");
  command
      ->add_option("--out", options->out, "folder for map.ot, painted.csv, report.json, report.html, plans/")
      ->required()
      ->check(file_name)
      ->type_name("DIR");
  add_map_flags(*command, options->resolution, options->integration, options->threads);
  command
      ->add_option("--planner", options->planners, "use this planner instead of the queries' own; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option(
          "--record", options->record,
          "write poses, scans, spheres, voxels and plans as ROS 2 messages, for Foxglove and rosbag2")
      ->check(file_name)
      ->type_name("FILE.mcap");
  command
      ->add_option("--overlay", options->overlay,
                   "folder for stills of each plan in the camera image: the robot at start, goal and minimum "
                   "clearance, or where to paint more")
      ->check(file_name)
      ->type_name("DIR");
  command
      ->add_option(
          "--video-out", options->video,
          "write a video of the recording with paint, probe and refusals, then of the robot's motion")
      ->check(file_name)
      ->type_name("FILE.mp4");
  add_seen_within(*command, options->seen_within, "; default: the queries' own");
  command->add_flag_callback(
      "--no-plan", [options] { options->plan = false; }, "stop after the map");
  command->add_option("--seed", options->seed, "random seed of the planners")
      ->type_name("N")
      ->check(whole_number);
  command->add_option("--time-limit", options->time_limit, "planning time limit per leg, seconds")
      ->check(positive())
      ->type_name("S");
  return [options](Console& c) { return run_replay(*options, c); };
}

Command add_teach(CLI::App& app, Console& console) {
  auto options = std::make_shared<TeachCommand>();
  CLI::App* command = add_command(
      app, "teach",
      "interactive session: paint free space, pick start and goal with a probe, plan and approve", console);
  add_source(*command, options->source, options->camera_seconds, "source",
             "a recording with images (see replay), or the folder of a recorded session");
  command
      ->add_option(
          "--setup", options->setup,
          "tag boards, ball probe, gripper probe and robot, by file or name; default: the recording's own")
      ->type_name("SETUP.yaml");
  command
      ->add_option("--events", options->events,
                   "user actions: one timed JSON object per line; default: keys pressed in the window")
      ->type_name("FILE.jsonl");
  command
      ->add_option("--keys", options->keys,
                   "additional key bindings, such as for a robot, a volume or a load: events with 'key' "
                   "instead of 'time'")
      ->type_name("FILE.jsonl");
  command->add_flag("--headless", options->headless, "run without a window");
  command
      ->add_option("--overlay", options->overlay,
                   "folder for stills of each plan in the camera image: start, goal, minimum clearance")
      ->type_name("DIR")
      ->check(file_name);
  command->add_option("--video-out", options->video, "write the session's images as a video")
      ->type_name("FILE.mp4")
      ->check(file_name);
  command
      ->add_option("--out", options->out,
                   "folder for what replay writes, approved/, and session/ for repeating it")
      ->required()
      ->check(file_name)
      ->type_name("DIR");
  add_map_flags(*command, options->resolution, options->integration, options->threads);
  command->add_option("--seed", options->seed, "random seed of the planners")
      ->type_name("N")
      ->check(whole_number);
  command->add_option("--time-limit", options->time_limit, "planning time limit per leg, seconds")
      ->check(positive())
      ->type_name("S");
  return [options](Console& c) { return run_teach(*options, c); };
}

Command add_plan(CLI::App& app, Console& console) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = add_command(app, "plan", "plan one query on a map, in one or several legs", console);
  command->add_option("--map", options->map, "folder written by replay, or .ot, .bt, .pcd, .ply")
      ->type_name("MAP");
  add_robot_flags(*command, options->robot);
  add_survey_flags(*command, options->survey);
  add_attach(*command, options->attach, "");
  add_pick(*command, options->pick, options->place, "; --goal is then an optional configuration to end at");
  command->get_option("--robot")->required(false);
  command
      ->add_option("--start", options->start,
                   "start configuration: comma-separated joint values, rad or m, or a state of the SRDF")
      ->type_name("Q");
  command
      ->add_option("--goal", options->goals,
                   "goal configuration, in the same form; several goals are legs of one path")
      ->type_name("Q")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option("--goal-pose", options->goal_poses,
                   "goal pose of the tip in the map frame instead of --goal: x,y,z[,roll,pitch,yaw], m and "
                   "rad; inverse kinematics chooses the free configuration nearest to the start of the leg; "
                   "several are legs")
      ->type_name("POSE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--tip", options->tip, "link that --goal-pose refers to; default: the robot's own tip")
      ->type_name("LINK");
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
  command->add_option("--seed", options->seed, "random seed of the planner")
      ->type_name("N")
      ->check(whole_number);
  command->add_option("--time-limit", options->time_limit, "planning time limit per leg, seconds")
      ->check(positive())
      ->type_name("S");
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
        ->check(number("a share above 0, at most 1", 1e-6, 1.0))
        ->capture_default_str()
        ->type_name("SHARE");
  };
  add_scale("--speed", options->scales.speed, "scaling of the joints' velocity limits");
  add_scale("--acceleration", options->scales.acceleration, "scaling of their acceleration limits");
  add_scale("--jerk", options->scales.jerk, "scaling of their jerk limits");
  command->add_option("--grip-time", options->grip_time, "rest where a load is grasped or released, seconds")
      ->check(number("seconds from 0 to 60", 0.0, 60.0))
      ->capture_default_str()
      ->type_name("S");
  return [options](Console& c) {
    if (!options->print_options) {
      for (const auto& [missing, flag] :
           {std::pair{options->map.empty(), "--map"}, std::pair{options->robot.robot.empty(), "--robot"},
            std::pair{options->start.empty(), "--start"},
            std::pair{options->goals.empty() && options->goal_poses.empty() && options->pick.empty(),
                      "--goal"}}) {
        if (missing) throw std::invalid_argument(std::string(flag) + " is required");
      }
    }
    return run_plan(*options, c);
  };
}

Command add_simulate(CLI::App& app, Console& console) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command =
      add_command(app, "simulate", "render a scene file as a recording with ground truth", console);
  command->add_option("scene", options->scene, "scene file, or the name of one that comes with the program")
      ->required()
      ->type_name("SCENE.yaml");
  command->add_option("--out", options->out, "recording to write (.rawlog); truth.json appears beside it")
      ->required()
      ->check(file_name)
      ->type_name("RECORDING");
  return [options](Console& c) { return run_simulate(*options, c); };
}

Command add_tags(CLI::App& app, Console& console) {
  auto options = std::make_shared<TagsPrintOptions>();
  CLI::App* command = add_command(
      app, "tags", "print tag boards, probes and a calibration board, with the matching setup", console);
  command->add_option("what", "print: sheets as SVG and PDF, and setup.yaml")
      ->required()
      ->check(CLI::IsMember({"print"}))
      ->type_name("print");
  command->add_option("--out", options->out, "folder for the sheets and setup.yaml")
      ->required()
      ->check(file_name)
      ->type_name("DIR");
  const auto add = [&](const char* flag, double& value, const char* what) {
    command->add_option(flag, value, what)
        ->capture_default_str()
        ->check(number("a length from 1 to 1000 (mm)", 1.0, 1000.0))
        ->type_name("MM");
  };
  add("--base-tag", options->base_tag, "side of a tag of the base board (2 x 3 tags)");
  add("--probe-tag", options->probe_tag, "side of a tag of the probe's cube");
  add("--ball-radius", options->ball_radius, "radius of the probe's ball");
  add("--stem", options->stem, "distance from the cube's lower face to the center of the ball");
  add("--gripper-tag", options->gripper_tag, "side of a tag of the gripper probe");
  add("--square", options->square, "side of a square of the calibration board (5 x 7 squares)");
  return [options](Console& c) { return run_tags_print(*options, c); };
}

/// CLI11's errors as one sentence of ours.
int report_usage_error(const CLI::App& app, const std::vector<std::string>& arguments,
                       const CLI::ParseError& error, Console& console) {
  std::string sentence = error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (arguments.empty()) {
    console.warn(app.help());
    return exit_bad_input;
  }
  const bool known = std::find(names.begin(), names.end(), arguments[0]) != names.end();
  if (!known && !arguments[0].starts_with('-')) {
    sentence = "unknown command '" + arguments[0] + "'";
    const std::string guess = meant(arguments[0], names);
    sentence += guess.empty() ? " (see clearway --help)" : "; did you mean '" + guess + "'?";
  } else if (known) {
    sentence = arguments[0] + ": " + sentence + " (see clearway " + arguments[0] + " --help)";
    std::vector<std::string> flags;
    const CLI::App* command = app.get_subcommand(arguments[0]);
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    }
    for (const std::string& argument : arguments) {
      const std::string flag = argument.substr(0, argument.find('='));
      if (!flag.starts_with("--") || std::find(flags.begin(), flags.end(), flag) != flags.end()) continue;
      const std::string guess = meant(flag, flags);
      sentence =
          arguments[0] + ": unknown flag '" + flag + "'" +
          (guess.empty() ? " (see clearway " + arguments[0] + " --help)" : "; did you mean '" + guess + "'?");
      break;
    }
  }
  console.warn("clearway: " + sentence);
  return exit_bad_input;
}

int run_guarded(const Command& command, Console& console) {
  try {
    return command(console);
  } catch (...) {
    const Failure failure = failure_of(std::current_exception());
    console.warn("clearway: " + failure.sentence);
    return failure.status;
  }
}

}  // namespace

int run_command_line(const std::vector<std::string>& arguments, Console& console) {
  CLI::App app("Paint free space, fuse it with what sensors see, and plan a robot arm inside it.",
               "clearway");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("clearway ") + CLEARWAY_VERSION);
  app.get_formatter()->column_width(16);
  app.add_flag_callback(
      "--manual", [&app] { throw Text{manual_page(app)}; }, "print the manual page (roff)");
  app.add_option_function<std::string>(
         "--completion", [&app](const std::string& shell) { throw Text{completion(app, shell)}; },
         "print the completion script for bash or zsh")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->type_name("SHELL");
  std::vector<std::pair<std::string, Command>> commands = {
      {"replay", add_replay(app, console)},     {"teach", add_teach(app, console)},
      {"plan", add_plan(app, console)},         {"check", add_check(app, console)},
      {"gate", add_gate(app, console)},         {"inspect", add_inspect(app, console)},
      {"compare", add_compare(app, console)},   {"import", add_import(app, console)},
      {"simulate", add_simulate(app, console)}, {"track", add_track(app, console)},
      {"tags", add_tags(app, console)},         {"calibrate", add_calibrate(app, console)},
  };
  add_command(app, "robots", "list the robots that come with the program", console);
  add_command(app, "planners", "list the planners", console);
  commands.emplace_back("robots", run_robots);
  commands.emplace_back("planners", run_planners);
  app.footer(
      "Each command explains its flags: clearway COMMAND --help\n"
      "Exit status: 0 done, 1 the answer is no, 2 usage or bad input, 3 damaged input.");
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    const auto chosen = app.get_subcommands();
    console.out() << (chosen.empty() ? app.help() : chosen.front()->help("clearway"));
    return exit_done;
  } catch (const Text& text) {
    console.out() << text.text;
    return exit_done;
  } catch (const CLI::CallForVersion&) {
    console.out() << app.version() << '\n';
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return report_usage_error(app, arguments, error, console);
  }
  for (const auto& [name, command] : commands) {
    if (app.got_subcommand(name)) return run_guarded(command, console);
  }
  return exit_bad_input;
}

}  // namespace clearway
