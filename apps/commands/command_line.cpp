#include "apps/commands/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ostream>

#include "apps/commands/manual.hpp"
#include "apps/console/build_stamp.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/failure.hpp"
#include "apps/console/flags.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {
namespace {

/// What a flag writes instead of running a command.
struct Text {
  std::string text;
};

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
      ->check(one_of({"print"}))
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
    sentence = "unknown command " + quote(arguments[0]);
    const std::string guess = nearest_name(arguments[0], names);
    sentence += guess.empty() ? " (see clearway --help)" : "; did you mean '" + guess + "'?";
  } else if (known) {
    sentence = arguments[0] + ": " + sentence + " (see clearway " + arguments[0] + " --help)";
    std::vector<std::string> flags;
    const CLI::App* command = app.get_subcommand(arguments[0]);
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) flags.push_back(name);
    }
    for (const std::string& argument : arguments) {
      const std::string flag = argument.substr(0, argument.find('='));
      const std::string name = flag.starts_with("--") ? flag.substr(2) : "";
      if (name.empty() || std::find(flags.begin(), flags.end(), name) != flags.end()) continue;
      const std::string guess = nearest_name(name, flags);
      sentence = arguments[0] + ": unknown flag " + quote(flag) +
                 (guess.empty() ? " (see clearway " + arguments[0] + " --help)"
                                : "; did you mean '--" + guess + "'?");
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
  const std::string_view commit = build_commit();
  app.set_version_flag("--version", std::string("clearway ") + CLEARWAY_VERSION +
                                        (commit == "unknown" ? "" : " (" + std::string(commit) + ")"));
  app.get_formatter()->column_width(16);
  app.add_flag_callback(
      "--manual", [&app] { throw Text{manual_page(app)}; }, "print the manual page (roff)");
  app.add_option_function<std::string>(
         "--completion", [&app](const std::string& shell) { throw Text{completion(app, shell)}; },
         "print the completion script for bash or zsh")
      ->check(one_of({"bash", "zsh"}))
      ->type_name("SHELL");
  std::vector<std::pair<std::string, Command>> commands = {
      {"replay", add_replay(app, console)},     {"teach", add_teach(app, console)},
      {"plan", add_plan(app, console)},         {"check", add_check(app, console)},
      {"gate", add_gate(app, console)},         {"inspect", add_inspect(app, console)},
      {"compare", add_compare(app, console)},   {"import", add_import(app, console)},
      {"simulate", add_simulate(app, console)}, {"track", add_track(app, console)},
      {"tags", add_tags(app, console)},         {"calibrate", add_calibrate(app, console)},
      {"robots", add_robots(app, console)},
  };
  add_command(app, "planners", "list the planners", console);
  commands.emplace_back("planners", run_planners);
  app.footer(
      "Each command explains its flags: clearway COMMAND --help\n"
      "Reference of what it reads and writes: datasets/FORMATS.md and apps/OUTPUTS.md, below\n"
      "share/doc/clearway where it is installed.\n"
      "Exit status: 0 done, 1 the answer is no, 2 usage or bad input, 3 damaged input.");
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::CallForHelp& help) {
    const auto chosen = app.get_subcommands();
    if (chosen.empty() && !arguments[0].starts_with('-'))
      return report_usage_error(app, arguments, help, console);
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
