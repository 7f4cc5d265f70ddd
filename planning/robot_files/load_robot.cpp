#include "planning/robot_files/load_robot.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <stdexcept>

#include "mapping/system/input_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/held_joints.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/allowed_collisions.hpp"
#include "planning/robot_files/robot_settings.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "planning/robot_files/urdf_file.hpp"
#include "planning/robot_files/xacro_file.hpp"

/// Where the package that a program was built with has its data: find_package(clearway) adds this to the
/// program.
extern "C" [[gnu::weak]] const char clearway_package_datasets[];

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// The .yaml or .urdf that a user's word means.
fs::path find_robot(const std::string& name_or_path) {
  const fs::path path = name_or_path;
  if (is_urdf_name(path) || extension_of(path) == ".yaml") return path;
  const fs::path known = datasets_folder() / "robots" / (name_or_path + ".yaml");
  if (!name_or_path.empty() && path.filename() == path && fs::is_regular_file(known)) return known;
  std::string names;
  for (const auto& [name, description] : available_robots()) names += (names.empty() ? "" : ", ") + name;
  throw std::invalid_argument("unknown robot " + quote(name_or_path) + ": expected one of " + names +
                              ", or the path of a .urdf, .xacro or .yaml file");
}

std::vector<std::pair<int, int>> exempt_pairs(const Robot& robot, const RobotSettings& settings,
                                              const fs::path& settings_file,
                                              const std::optional<Srdf>& srdf) {
  std::vector<std::pair<int, int>> pairs = adjacent_bodies(robot);
  const auto append = [&](const std::vector<std::pair<int, int>>& more) {
    pairs.insert(pairs.end(), more.begin(), more.end());
  };
  append(never_meeting_bodies(robot));
  std::vector<std::string> links;
  for (const Link& link : robot.links) links.push_back(link.name);
  const bool says_pairs = srdf && !(srdf->disabled.empty() && srdf->disabled_links.empty());
  if (!says_pairs && !settings.exempt) append(always_colliding_bodies(robot));
  if (srdf) {
    const auto tested = bodies_of_parts(robot, tested_pairs(*srdf, links), robot.srdf);
    std::erase_if(pairs, [&](const std::pair<int, int>& pair) {
      return std::find(tested.begin(), tested.end(),
                       std::pair<int, int>(std::minmax(pair.first, pair.second))) != tested.end();
    });
    append(bodies_of_parts(robot, untested_pairs(*srdf, links), robot.srdf));
  }
  if (settings.exempt) append(bodies_of_parts(robot, *settings.exempt, settings_file));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Of what both state, what was asked for counts. Settings that lie beside a .urdf may be those of the
/// .xacro from which it was made.
std::map<std::string, std::string> xacro_arguments(const RobotRequest& request, const RobotSettings& settings,
                                                   const fs::path& file, const fs::path& urdf) {
  if (extension_of(urdf) != ".xacro" && is_urdf_name(file) && request.xacro.empty()) return {};
  std::map<std::string, std::string> arguments = request.xacro;
  arguments.insert(settings.xacro.begin(), settings.xacro.end());
  if (!arguments.empty() && extension_of(urdf) != ".xacro")
    throw std::invalid_argument(urdf.string() + ": is no .xacro file, expected one for xacro argument " +
                                quote(arguments.begin()->first));
  return arguments;
}

/// The SRDF that was asked for, that the settings name, or that lies beside the URDF; empty: none.
fs::path srdf_of(const RobotRequest& request, const RobotSettings& settings, const fs::path& settings_file,
                 const fs::path& urdf) {
  if (!request.srdf.empty()) return request.srdf;
  if (!settings.srdf.empty()) return settings_file.parent_path() / settings.srdf;
  const fs::path beside = beside_urdf(urdf, ".srdf");
  return is_input_there(beside) ? beside : fs::path();
}

/// Where a joint stands that nobody fixes: in the state "default", else at 0 within its limits.
HeldJoint at_rest(const Robot& robot, const Joint& joint) {
  for (const NamedState& state : robot.states) {
    const auto value = state.values.find(joint.name);
    if (state.name != "default" || value == state.values.end()) continue;
    return {joint.name, value->second, HoldSource::default_state};
  }
  return {joint.name, std::clamp(0.0, joint.lower, joint.upper), HoldSource::zero};
}

bool has_joint(const Robot& robot, const std::string& name) {
  return std::any_of(robot.joints.begin(), robot.joints.end(),
                     [&](const Joint& joint) { return joint.name == name; });
}

/// A state may list a joint that follows another (mimic) only beside that one, and where that one takes it.
void require_followed(const Robot& robot, const Srdf::State& state, const std::string& joint, double value,
                      const std::set<std::string>& planned, const std::map<std::string, double>& fixed) {
  const auto link = std::find_if(robot.links.begin(), robot.links.end(), [&](const Link& other) {
    return other.joint_name == joint && other.joint >= 0;
  });
  if (link == robot.links.end()) return;
  const std::string& master = robot.joints[static_cast<std::size_t>(link->joint)].name;
  if (master == joint || planned.contains(master) || fixed.contains(master)) return;
  const auto own = state.values.find(master);
  const std::string follows = "--fix: state " + quote(state.name) + " of group " + quote(state.group) +
                              " has joint " + quote(joint) + " at " + to_text(value) +
                              ", which follows joint " + quote(master);
  if (own == state.values.end())
    throw std::invalid_argument(follows + ", and not that one; expected its value");
  const double taken =
      link->multiplier * own->second + link->offset;  // about the master's axis, or against it
  if (std::abs(std::abs(taken) - std::abs(value)) > 1e-6)
    throw std::invalid_argument(follows + ", by which it would be elsewhere; expected values that agree");
}

/// What the states that were asked for say of joints that are not planned.
std::map<std::string, double> fixed_by_states(const Robot& robot, const RobotRequest& request,
                                              const std::optional<Srdf>& srdf,
                                              const std::set<std::string>& planned) {
  std::map<std::string, double> fixed;
  std::map<std::string, std::string> origins;  // which state fixed a joint
  std::vector<std::string> known;
  if (srdf)
    for (const Srdf::State& state : srdf->states) known.push_back(state.name);
  for (const std::string& name : request.fixed_states) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw std::invalid_argument(
          "--fix: expected JOINT=VALUE or a state of a SRDF, got " + quote(name) +
          (known.empty() ? ", and the robot has no SRDF with states" : "; " + suggestion(name, known)));
    for (const Srdf::State& state : srdf->states) {
      if (state.name != name) continue;
      const std::string origin = quote(state.name) + " of group " + quote(state.group);
      for (const auto& [joint, value] : state.values) {
        require_followed(robot, state, joint, value, planned, request.fixed);
        if (planned.contains(joint) || request.fixed.contains(joint) || !has_joint(robot, joint)) continue;
        if (!fixed.emplace(joint, value).second && fixed[joint] != value)
          throw std::invalid_argument("--fix: states " + origins[joint] + " and " + origin + " have joint " +
                                      quote(joint) + " at " + to_text(fixed[joint]) + " and at " +
                                      to_text(value) + ", expected one of them or --fix " + shortened(joint) +
                                      "=VALUE");
        origins.emplace(joint, origin);
      }
    }
  }
  return fixed;
}

/// Holds what is fixed, and what is outside of the planning group, `moving` aside.
Robot hold(const Robot& robot, const RobotRequest& request, const RobotSettings& settings,
           const fs::path& settings_file, const std::optional<Srdf>& srdf,
           const std::set<std::string>& moving = {}) {
  if (!robot.group.empty() && !srdf)
    throw std::invalid_argument("group " + quote(robot.group) + " of robot " + quote(robot.name) +
                                ": expected a SRDF that defines it, by --srdf or beside the URDF");
  std::set<std::string> planned;
  if (!robot.group.empty()) planned = joints_of_group(robot, *srdf, robot.group, robot.srdf);
  std::map<std::string, double> asked = request.fixed;
  asked.merge(fixed_by_states(robot, request, srdf, planned));
  std::vector<HeldJoint> held;
  for (const auto& [name, value] : asked) held.push_back({name, value, HoldSource::asked});
  for (const auto& [name, value] : settings.fixed)
    if (!asked.contains(name)) held.push_back({name, value, HoldSource::settings});
  if (!robot.group.empty()) {
    for (const Joint& joint : robot.joints) {
      const bool is_fixed = asked.contains(joint.name) || settings.fixed.contains(joint.name);
      if (!is_fixed && !planned.contains(joint.name)) held.push_back(at_rest(robot, joint));
    }
  }
  std::erase_if(held, [&](const HeldJoint& joint) { return moving.contains(joint.name); });
  return held.empty() ? robot : with_held_joints(robot, held, settings_file);
}

/// The links that may touch what the robot stands on. @throws std::invalid_argument for those that move.
std::vector<std::string> standing_links(const Robot& robot, const RobotRequest& request,
                                        const RobotSettings& settings) {
  std::set<std::string> standing(request.standing.begin(), request.standing.end());
  standing.insert(settings.standing.begin(), settings.standing.end());
  std::vector<std::string> names;
  for (const Link& link : robot.links) names.push_back(link.name);
  for (const std::string& name : standing) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw std::invalid_argument("standing: robot " + quote(robot.name) + " has no link " + quote(name) +
                                  ", " + suggestion(name, names));
    if (is_moved(robot, static_cast<int>(found - names.begin())) &&
        std::find(request.standing.begin(), request.standing.end(), name) != request.standing.end())
      throw std::invalid_argument("standing: a joint that is planned moves link " + quote(name) +
                                  " of robot " + quote(robot.name) +
                                  ", expected one that stands still (--fix, --group)");
  }
  return {standing.begin(), standing.end()};
}

/// Spheres that hold each body, in the frame of its link.
void cover_bodies(Robot& robot) {
  for (Body& body : robot.bodies) {
    body.cover = body.shape.sphere_cover();
    for (Sphere& sphere : body.cover) sphere.center = body.link_from_shape * sphere.center;
  }
}

/// The library that holds this code, where a program has loaded one; empty: it is the program's own.
fs::path own_library() {
  Dl_info info{};
  link_map* library = nullptr;
  const int found = dladdr1(reinterpret_cast<const void*>(&cover_bodies), &info,
                            reinterpret_cast<void**>(&library), RTLD_DL_LINKMAP);
  return found == 0 || library == nullptr ? fs::path() : fs::path(library->l_name);
}

/// share/clearway in the folder under which that library lies, as lib/python3/dist-packages/clearway; empty:
/// none.
fs::path beside_library() {
  std::error_code failed;
  const fs::path library = own_library();
  if (library.empty()) return {};
  fs::path folder = fs::canonical(library, failed).parent_path();
  for (int up = 0; up < 5 && !failed; ++up) {
    folder = folder.parent_path();
    if (fs::is_directory(folder / "share/clearway/robots", failed))
      return fs::canonical(folder / "share/clearway");
    failed.clear();
  }
  return {};
}

}  // namespace

fs::path datasets_folder() {
  const char* chosen = std::getenv("CLEARWAY_DATASETS");
  if (chosen && *chosen) {
    if (fs::is_directory(fs::path(chosen) / "robots")) return chosen;
    throw std::invalid_argument("CLEARWAY_DATASETS is " + quote_path(chosen) +
                                ": expected a folder that holds a folder 'robots'");
  }
  if (const fs::path found = beside_library(); !found.empty()) return found;
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const fs::path beside = program.parent_path().parent_path() / "share" / "clearway";
  if (!failed && fs::is_directory(beside / "robots", failed)) return fs::canonical(beside);
  if (clearway_package_datasets && fs::is_directory(fs::path(clearway_package_datasets) / "robots", failed))
    return clearway_package_datasets;
  const fs::path installed = CLEARWAY_FALLBACK_DATASETS;
  return fs::is_directory(installed / "robots", failed) ? installed : fs::path("/usr/share/clearway");
}

std::vector<std::pair<std::string, std::string>> available_robots() {
  std::vector<std::pair<std::string, std::string>> robots;
  const fs::path folder = datasets_folder() / "robots";
  if (!fs::is_directory(folder))
    throw std::invalid_argument("no folder of robots at " + quote_path(folder.string()) +
                                ": expected it there, or CLEARWAY_DATASETS to name the folder that holds it");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    robots.emplace_back(entry.path().stem().string(), read_robot_settings(entry.path()).description);
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

namespace {

/// Numbers that are in other units, as they are not URDF's.
std::vector<std::string> unit_notes(const Robot& robot) {
  constexpr double most_turned = 50.0, largest_body = 20.0, most_slid = 500.0;  // rad, m, m
  std::vector<std::string> notes;
  for (const Joint& joint : robot.joints) {
    const double turned = joint.upper - joint.lower;
    if (joint.kind == JointKind::revolute && std::isfinite(turned) && turned > most_turned)
      notes.push_back("joint " + quote(joint.name) + " turns by " + short_text(turned, 3) +
                      " rad: are its limits in degrees? URDF has radians");
    if (turned == 0.0 && joint.lower_follower.empty() && joint.upper_follower.empty())
      notes.push_back("joint " + quote(joint.name) + " cannot move: its lower and upper limit are both " +
                      short_text(joint.lower / (joint.kind == JointKind::prismatic ? robot.scale : 1.0) + 0.0,
                                 4));  // not -0
    if (joint.kind == JointKind::prismatic && std::isfinite(turned) && turned > most_slid * robot.scale)
      notes.push_back("joint " + quote(joint.name) + " slides by " + short_text(turned / robot.scale, 3) +
                      " m: are its limits in millimetres? URDF has metres");
  }
  for (const Joint& joint : robot.joints) {
    const std::string &below = joint.lower_follower, &above = joint.upper_follower;
    if (below.empty() && above.empty()) continue;
    const bool are_two = !below.empty() && !above.empty() && below != above;
    notes.push_back("joint " + quote(joint.name) + " keeps from " + short_text(joint.lower, 4) + " to " +
                    short_text(joint.upper, 4) + ": " +
                    (are_two ? "joints " + quote(below) + " and " + quote(above) + ", which mimic it, have"
                             : "joint " + quote(below.empty() ? above : below) + ", which mimics it, has") +
                    " such limits");
  }
  const Body* largest = nullptr;
  for (const Body& body : robot.bodies) {
    const bool is_load = std::any_of(robot.loads.begin(), robot.loads.end(),
                                     [&](const Load& load) { return load.name == body.part; });
    const bool is_larger =
        largest == nullptr || body.shape.bounding_radius() > largest->shape.bounding_radius();
    if (!is_load && is_larger) largest = &body;
  }
  const double size = largest == nullptr ? 0.0 : 2.0 * largest->shape.bounding_radius() / robot.scale;
  if (size > largest_body)
    notes.push_back("part " + quote(largest->part) + " has a body " + short_text(size, 3) +
                    " m across: is its mesh in millimetres? scale=\"0.001 0.001 0.001\" makes it metres");
  for (const Load& load : robot.loads)
    if (std::string note = size_note(load); !note.empty()) notes.push_back(std::move(note));
  return notes;
}

}  // namespace

std::vector<std::string> robot_notes(const Robot& robot, const PackageFolders& packages) {
  std::vector<std::string> notes = srdf_notes(robot);
  for (const std::string& note : unit_notes(robot)) notes.push_back(note);
  if (robot.xacro.empty() || robot.source.empty()) return notes;
  const std::vector<std::string> more = xacro_notes(urdf_of_robot(robot), robot.xacro, packages);
  notes.insert(notes.end(), more.begin(), more.end());
  return notes;
}

Robot load_robot(const std::string& name_or_path) { return load_robot(RobotRequest{name_or_path}); }

Robot load_robot(const RobotRequest& request) {
  const fs::path file = find_robot(request.robot);
  const bool is_urdf = is_urdf_name(file);
  const fs::path settings_file = is_urdf ? beside_urdf(file, ".yaml") : file;
  RobotSettings settings;
  if (!is_urdf || is_input_there(settings_file)) settings = read_robot_settings(settings_file);
  const fs::path urdf = urdf_of(file, settings);

  Robot robot =
      read_urdf(urdf, request.packages, xacro_arguments(request, settings, file, urdf), settings.mesh_pieces);
  apply_settings(settings, settings_file, robot);
  robot.name = file.stem().string();
  robot.source = file;
  robot.srdf = srdf_of(request, settings, settings_file, urdf);
  robot.group = request.group.empty() ? settings.group : request.group;
  std::optional<Srdf> srdf;
  if (!robot.srdf.empty()) {
    srdf = read_srdf(robot.srdf);
    robot.states = states_of(*srdf, robot.group);
  }
  robot.exempt = exempt_pairs(robot, settings, settings_file, srdf);  // while every joint may still move
  const Robot free = robot;
  robot = hold(free, request, settings, settings_file, srdf);
  robot.standing = standing_links(robot, request, settings);
  if (settings.tip_link.empty()) place_tip(free, srdf, robot);
  if (!request.moving.empty()) {
    Robot moved = hold(free, request, settings, settings_file, srdf, request.moving);
    moved.standing = robot.standing, moved.tip_link = robot.tip_link;
    moved.tip_choice = robot.tip_choice;
    robot = std::move(moved);
  }
  cover_bodies(robot);
  return settings.scale == 1.0 ? robot : scaled(robot, settings.scale);
}

}  // namespace clearway
