#include "apps/console/flags.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <limits>
#include <memory>
#include <sstream>

#include "apps/console/parse.hpp"
#include "datasets/pictures/video.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

Check number(const std::string& expected, double low, double high) {
  return [=](const std::string& text) {
    double value = 0.0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good =
        error == std::errc() && stop == text.data() + text.size() && value >= low && value <= high;
    return good ? std::string() : "expected " + expected + ", got '" + text + "'";
  };
}

Check positive() {
  return number("a positive number up to 1000000000", std::numeric_limits<double>::min(), 1e9);
}

std::string whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && stop == text.data() + text.size();
  return good ? "" : "expected a whole number from 0 to 18446744073709551615, got '" + text + "'";
}

std::string file_name(const std::string& text) { return text.empty() ? "expected a file name, got ''" : ""; }

CLI::Validator one_of(const std::vector<std::string>& values) {
  std::string expected, set;
  for (std::size_t i = 0; i < values.size(); ++i) {
    expected += (i == 0 ? "" : i + 1 < values.size() ? ", " : " or ") + values[i];
    set += (i == 0 ? "{" : ",") + values[i];
  }
  return {[=](const std::string& text) {
            const bool is_known = std::find(values.begin(), values.end(), text) != values.end();
            return is_known ? std::string() : "expected " + expected + ", got " + quote(text);
          },
          set + "}"};
}

namespace {

/// Where the closed set begins in the name of a type, as CLI11 has it: "AXIS:{x,y,z}".
std::size_t set_begin(const std::string& type) { return std::min(type.find(":{"), type.size()); }

}  // namespace

std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = set_begin(type);
  std::vector<std::string> values;
  if (begin == type.size()) return values;
  std::istringstream set(type.substr(begin + 2, type.find('}', begin) - begin - 2));
  for (std::string value; std::getline(set, value, ',');) values.push_back(value);
  return values;
}

std::string type_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, set_begin(type));
}

Check file_of_kind(const std::string& ending) {
  return [=](const std::string& text) {
    std::string given = std::filesystem::path(text).extension().string();
    std::transform(given.begin(), given.end(), given.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return given == ending ? std::string()
                           : "expected a file name that ends in " + ending + ", got " + quote(text);
  };
}

namespace {

/// Help in which only an option that takes several values after its name has "..." behind them, and in which
/// closed sets stand in descriptions alone.
class OptionHelp : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string more = " ...";
    if (const auto at = text.find(more); at != std::string::npos && !option->get_allow_extra_args())
      text.erase(at, more.size());
    if (const auto at = text.find(":{"); at != std::string::npos) text.erase(at, text.find('}', at) + 1 - at);
    return text;
  }
};

}  // namespace

CLI::Option* add_file(CLI::App& command, const std::string& flag, std::filesystem::path& file,
                      const std::string& text, const std::string& type) {
  return command.add_option(flag, file, text)->type_name(type)->check(file_name);
}

CLI::Option* add_repeatable(CLI::App& command, const std::string& flag, std::vector<std::string>& values,
                            const std::string& text, const std::string& type) {
  return command.add_option(flag, values, text)->type_name(type)->allow_extra_args(false)->take_all();
}

CLI::Option* add_repeatable(CLI::App& command, const std::string& flag,
                            std::vector<std::filesystem::path>& files, const std::string& text,
                            const std::string& type) {
  return command.add_option(flag, files, text)->type_name(type)->allow_extra_args(false)->take_all();
}

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      Console& console) {
  CLI::App* command = app.add_subcommand(name, description);
  command->formatter(std::make_shared<OptionHelp>());
  command->add_flag("--quiet", console.quiet, "no log, no progress; results and warnings still appear");
  command->add_flag("--json", console.json,
                    "print one JSON object on stdout and nothing else there; apps/OUTPUTS.md has its keys");
  command->get_formatter()->column_width(36);
  return command;
}

void add_source(CLI::App& command, std::filesystem::path& source, double& seconds, const std::string& name,
                const std::string& text) {
  std::string type = name;
  std::transform(type.begin(), type.end(), type.begin(), [](unsigned char c) { return std::toupper(c); });
  CLI::Option* positional = command.add_option(name, source, text)->required()->type_name(type);
  command
      .add_option_function<int>(
          "--camera",
          [&source, positional](int camera) {
            positional->required(false);
            source = "/dev/video" + std::to_string(camera);
          },
          "read a live camera instead, by its number")
      ->trigger_on_parse()
      ->check(number("a whole number from 0 to 255", 0, 255))
      ->excludes(positional)
      ->type_name("N");
  const CLI::Option* limit =
      command.add_option("--seconds", seconds, "how long to read a live camera, seconds")
          ->check(number("a number from 0.1 to 86400", 0.1, 86400.0))
          ->type_name("S");
  command.final_callback([&source, limit] {
    if (limit->count() > 0 && !is_camera_name(source))
      throw CLI::ValidationError("--seconds", "expected a live camera (--camera N), got " +
                                                  quote_path(source.string()) + ", which is read whole");
  });
}

void add_planning_flags(CLI::App& command, std::uint64_t& seed, double& time_limit) {
  command.add_option("--seed", seed, "random seed for planning")->type_name("N")->check(whole_number);
  command
      .add_option("--time-limit", time_limit,
                  "planning time limit per leg, seconds; of one that fails, where to paint more is looked "
                  "for as long again, 5 s at most")
      ->check(positive())
      ->type_name("S");
}

void add_seen_within(CLI::App& command, std::optional<double>& seconds, const std::string& note) {
  command
      .add_option("--seen-within", seconds,
                  "under known_free, voxels last seen free more than S seconds before the map's newest "
                  "observation count as unknown; painted voxels do not age" +
                      note)
      ->check(positive())
      ->type_name("S");
}

namespace {

const std::string default_policy =
    "; default: painted for critical parts (known_free where the map has no paint), not_occupied for others; "
    "if the robot names no critical part, known_free for all, or not_occupied if the map holds obstacles "
    "only";

}  // namespace

void add_model_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes) {
  command.add_option("--robot", choice.robot, "name (see `clearway robots`), .yaml, .urdf or .xacro file")
      ->required()
      ->type_name("ROBOT");
  add_group_flags(command, choice, notes);
}

void add_group_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes) {
  add_file(command, "--srdf", choice.srdf,
           "SRDF with planning groups, states and disabled collision pairs; default: the robot's own",
           "FILE");
  command
      .add_option("--group", choice.group,
                  "planning group of the SRDF; other joints are held fixed" + notes.group)
      ->type_name("NAME");
  add_repeatable(
      command, "--fix", choice.fixed,
      "hold a joint at this value, rad or m at full size, or what a state of the SRDF says of joints "
      "outside of the group; they are then not part of Q; repeatable" +
          notes.fixed,
      "JOINT=VALUE");
  add_repeatable(
      command, "--standing", choice.standing,
      "link on a joint that is held, as a wheel: it may touch what the robot stands on, as its base "
      "may; repeatable",
      "LINK");
  add_repeatable(command, "--package", choice.packages,
                 "folder of a ROS package that mesh URLs name (package://NAME/…); default: folders above "
                 "the URDF, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH; repeatable",
                 "NAME=DIR");
  add_repeatable(command, "--xacro", choice.xacro,
                 "argument of a robot's .xacro file, passed on to the program xacro; repeatable",
                 "NAME:=VALUE");
}

void add_padding(CLI::App& command, std::optional<double>& padding, const std::string& note) {
  command
      .add_option_function<std::string>(
          "--padding",
          [&padding](const std::string& text) {
            padding.reset();
            if (text != "auto") padding = parse_numbers(text, "--padding").front();
          },
          "minimum distance of every part to obstacles, metres; auto: the robot's position accuracy (1 mm at "
          "full size if its settings state none)" +
              note)
      ->check([](const std::string& text) {
        return text == "auto" ? std::string() : number("a length from 0 to 100 (metres)", 0.0, 100.0)(text);
      })
      ->type_name("auto|M");
}

void add_place_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes) {
  command.add_option("--scale", choice.scale, "scale of the robot, 1 is full size" + notes.scale)
      ->check(number("a factor from 0.000001 to 1000", least_scale, most_scale))
      ->type_name("S");
  command
      .add_option("--base", choice.base,
                  "pose of the base in the map frame: x,y,z[,roll,pitch,yaw], m and rad" + notes.base)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number("numbers from -1000000000 to 1000000000", -1e9, 1e9))
      ->type_name("POSE");
}

void add_robot_flags(CLI::App& command, RobotChoice& choice, const RobotFlagNotes& notes) {
  add_model_flags(command, choice, notes);
  add_place_flags(command, choice, notes);
  add_repeatable(command, "--policy", choice.policies,
                 "what counts as free: painted, known_free or not_occupied (unknown counts as free), for "
                 "all parts, or PART=P for one; repeatable; a load that none names lies in what holds it" +
                     (notes.policy.empty() ? default_policy : notes.policy),
                 "[PART=]P");
  add_padding(command, choice.padding,
              notes.padding.empty() ? "; 0 must be given explicitly; default: auto" : notes.padding);
  add_seen_within(command, choice.seen_within, notes.seen_within);
}

void add_attach(CLI::App& command, std::vector<std::filesystem::path>& files, const std::string& note) {
  add_repeatable(command, "--attach", files,
                 "attach a load to the robot: a YAML file with its shape, link, pose, mass, touch links and "
                 "legs; repeatable" +
                     note,
                 "LOAD.yaml")
      ->check(file_name);
}

void add_pick(CLI::App& command, std::filesystem::path& file, std::string& place, const std::string& note) {
  add_file(
      command, "--pick", file,
      "pick and place an object of the map, in the legs approach, reach, lift, carry, lower and retreat: "
      "a YAML file with its shape, pose, link, touch links, grasp, place, approach (default: 0.1 m "
      "down), "
      "lift (0.1 m) and contact (two voxels and twice the padding)" +
          note,
      "PICK.yaml");
  command
      .add_option(
          "--place", place,
          "place pose of the object: x,y,z[,roll,pitch,yaw], m and rad; without angles it keeps those of its "
          "pose; default: the file's")
      ->type_name("POSE");
}

CLI::Option* add_map(CLI::App& command, std::filesystem::path& map, std::optional<double>& resolution,
                     const std::string& name, const std::string& note) {
  CLI::Option* option =
      command
          .add_option(name, map,
                      "folder written by replay, or .ot, .bt, .pcd, .ply, .bin, .xyz, .asc, .pts" + note)
          ->type_name("MAP");
  command
      .add_option("--cloud-resolution", resolution,
                  "edge of the voxels that the points of a .pcd, .ply, .bin, .xyz, .asc or .pts map stand "
                  "for, metres; default: what the file states, else 0.02, or, of a thinned surface, 1.25 "
                  "times the distance of its points; gaps between points of less than two edges count as "
                  "surface")
      ->check(number("metres from 0.0001 to 100", 1e-4, 100.0))
      ->type_name("M");
  return option;
}

namespace {

/// --goal-pose, --tip, --position-tolerance, --turn-tolerance and --free-axis.
void add_goal_poses(CLI::App& command, GoalPoseChoice& choice, const std::string& note) {
  add_repeatable(command, "--goal-pose", choice.poses,
                 "goal pose of the tip in the map frame instead of --goal: x,y,z[,roll,pitch,yaw], m and "
                 "rad; several are legs" +
                     note,
                 "POSE");
  command
      .add_option(
          "--tip", choice.tip,
          "link, or end effector of the SRDF and by it the link that it hangs on, whose frame --goal-pose "
          "and the grasp of --pick place; default: the robot's own tip: of its settings, else of its "
          "planning "
          "group, else the hand or tool frame of the arm with the most joints (`clearway robots` names it)")
      ->type_name("LINK");
  command
      .add_option("--position-tolerance", choice.position_tolerance,
                  "how far from its goal pose the tip may end, m")
      ->check(number("metres from 0 to 10", 0.0, 10.0))
      ->capture_default_str()
      ->type_name("M");
  command
      .add_option("--turn-tolerance", choice.turn_tolerance,
                  "by which angle its orientation may differ from the goal pose's, rad")
      ->check(number("radians from 0 to 3.1416", 0.0, 3.1416))
      ->capture_default_str()
      ->type_name("RAD");
  command
      .add_option("--free-axis", choice.free_axis,
                  "axis of the tip about which it may turn as it likes at a goal pose: x, y or z")
      ->check(one_of({"x", "y", "z"}))
      ->type_name("AXIS");
}

}  // namespace

void add_stops(CLI::App& command, QueryChoice& choice, const std::string& start, const std::string& goal,
               const std::string& goal_pose) {
  command
      .add_option(
          "--start", choice.start,
          "start configuration: comma-separated joint values, rad or m, or a state of the SRDF" + start)
      ->type_name("Q");
  add_repeatable(command, "--goal", choice.goals, "goal configuration, in the same form" + goal, "Q");
  add_goal_poses(command, choice.goal_poses, goal_pose);
  command.add_flag("--degrees", choice.degrees, "--start and --goal in degrees (revolute joints)");
}

void add_dynamics(CLI::App& command, DynamicsChoice& dynamics, const std::string& payload,
                  const std::string& gravity) {
  command
      .add_option("--payload", dynamics.payload,
                  "payload mass at the tip, for path cost and torques, kg at full size" + payload)
      ->check(number("a mass from 0 to 1000000 (kg)", 0.0, 1e6))
      ->type_name("KG");
  command
      .add_option("--gravity", dynamics.gravity,
                  "gravity vector x,y,z in the map frame, for path cost and torques, m/s^2" + gravity)
      ->delimiter(',')
      ->expected(3)
      ->allow_extra_args(false)
      ->check(number("numbers from -1000 to 1000", -1e3, 1e3))
      ->type_name("G");
}

void add_allow_outside(CLI::App& command, std::vector<std::string>& allow_outside) {
  add_repeatable(command, "--allow-outside", allow_outside,
                 "let a part with policy not_occupied leave the map's bounds, or all parts; repeatable",
                 "PART|all");
}

void add_survey_flags(CLI::App& command, SurveyDemands& demands) {
  add_allow_outside(command, demands.allow_outside);
  command.add_flag(
      "--strict", demands.strict,
      "refuse if a fixed body touches occupied voxels, or if a link has visual but no collision geometry");
}

}  // namespace clearway
