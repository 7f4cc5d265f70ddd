#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/planning_scene.hpp"
#include "datasets/yaml/message_keys.hpp"
#include "datasets/yaml/whole_turn.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"

namespace clearway {
namespace {

double length_of(const JsonField& field) {
  const double value = field.number();
  if (!(value >= 1e-9 && value <= 1e3)) field.refuse("a positive length up to 1000 (metres)");
  return value;
}

constexpr const char* turn_keys[] = {"orientation_quat_xyzw", "orientation_quat_wxyz", "quaternion_xyzw",
                                     "orientation_euler_xyz", "rpy"};

Eigen::Matrix3d turn_of(const JsonField& turn, std::string_view key) {
  if (key == "orientation_euler_xyz" || key == "rpy") {
    const Eigen::VectorXd angles = turn.numbers(3);
    if (!std::all_of(angles.begin(), angles.end(), is_within_turn))
      turn.refuse("angles in radians, each within a whole turn");
    return rotation_from_rpy(angles[0], angles[1], angles[2]);
  }
  const Eigen::Vector4d given = turn.numbers(4);
  const bool is_w_first = key == "orientation_quat_wxyz";
  const Eigen::Vector4d xyzw = is_w_first ? Eigen::Vector4d(given[1], given[2], given[3], given[0]) : given;
  if (const std::string fault = unit_fault(xyzw, is_w_first ? "w, x, y, z" : "x, y, z, w"); !fault.empty())
    turn.refuse(fault);
  return pose_of_quaternion(Eigen::Vector3d::Zero(), xyzw).linear();
}

/// Position, and a turn as a quaternion or as angles about the fixed axes x, y, z; where there are several,
/// they agree.
Eigen::Isometry3d pose_of_object(const JsonField& object) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = object.at("position").numbers(3);
  if (pose.translation().cwiseAbs().maxCoeff() > 1e3)
    object.at("position").refuse("a place within 1000 metres");
  const char* first = nullptr;
  for (const char* key : turn_keys) {
    if (!object.has(key)) continue;
    const Eigen::Matrix3d turn = turn_of(object.at(key), key);
    if (first == nullptr) {
      first = key;
      pose.linear() = turn;
    } else if (!turn.isApprox(pose.linear(), 1e-3)) {
      object.at(key).refuse("the same turn as " + quote(first) + " says");
    }
  }
  return pose;
}

/// Refuses keys that would say where or how large a solid is, and are not known; returns other unknown ones.
std::vector<std::string> unknown_keys(const JsonField& object, const std::set<std::string>& sizes) {
  std::vector<std::string> unknown;
  for (const auto& [key, value] : object.members()) {
    const bool is_turn = std::find(std::begin(turn_keys), std::end(turn_keys), key) != std::end(turn_keys);
    if (value.is_null() || key == "name" || key == "position" || is_turn || sizes.contains(key)) continue;
    if (key == "orientation")
      value.refuse(
          "'orientation_quat_xyzw', 'orientation_quat_wxyz' or 'orientation_euler_xyz' in its place, as it "
          "does "
          "not say in which order its numbers are");
    if (tells_of_space(key))
      value.refuse("no such key, or one of position, " +
                   listed({std::begin(turn_keys), std::end(turn_keys)}) + ", " +
                   listed({sizes.begin(), sizes.end()}));
    unknown.push_back(key);
  }
  return unknown;
}

void add_solids(const JsonField& problem, const char* kind, ForeignWorld& world,
                std::vector<std::string>& left_out) {
  static const std::map<std::string, std::set<std::string>> sizes{{"sphere", {"radius"}},
                                                                  {"cylinder", {"radius", "length"}},
                                                                  {"capsule", {"radius", "length"}},
                                                                  {"box", {"half_extents"}}};
  if (!problem.has(kind)) return;
  std::size_t number = 0;
  for (const JsonField& object : problem.at(kind).items()) {
    ForeignSolid solid;
    solid.kind = kind;
    ++number;
    solid.object = object.has("name") ? object.at("name").text() : kind + std::to_string(number);
    for (const std::string& key : unknown_keys(object, sizes.at(kind)))
      left_out.push_back(world.name + ": " + quote(key) + " of " + kind + " " + quote(solid.object));
    solid.map_from_shape = pose_of_object(object);
    if (solid.kind == "sphere") {
      solid.shape = Shape::sphere(length_of(object.at("radius")));
    } else if (solid.kind == "capsule") {
      solid.shape = Shape::capsule(length_of(object.at("radius")), length_of(object.at("length")));
    } else if (solid.kind == "cylinder") {
      solid.shape = Shape::cylinder(length_of(object.at("radius")), length_of(object.at("length")));
    } else {
      const Eigen::Vector3d half = object.at("half_extents").numbers(3);
      if (!(half.minCoeff() >= 1e-9 && half.maxCoeff() <= 1e3))
        object.at("half_extents").refuse("three positive lengths up to 1000 (metres)");
      solid.shape = Shape::box(2.0 * half);
    }
    world.solids.push_back(std::move(solid));
  }
}

std::vector<double> values_of(const JsonField& field) {
  std::vector<double> values;
  for (const JsonField& item : field.items()) values.push_back(item.number());
  if (values.empty() || values.size() > 500) field.refuse("1 to 500 joint values");
  return values;
}

/// In the robot's own order, or by names, of which there are as many.
ForeignState state_of(const JsonField& field, const std::vector<std::string>& names) {
  const std::vector<double> values = values_of(field);
  if (names.empty()) return {{}, values};
  if (values.size() != names.size())
    field.refuse(counted(names.size(), "value") + ", one for each of the joints that the file names");
  ForeignState state;
  for (std::size_t j = 0; j < names.size(); ++j) state.by_joint[names[j]] = values[j];
  return state;
}

/// The joints whose values a list has, in its order; empty where `parent` has no such `key`.
std::vector<std::string> joint_names(const JsonField& parent, const char* key) {
  std::vector<std::string> names;
  if (!parent.has(key)) return names;
  for (const JsonField& name : parent.at(key).items()) names.push_back(name.text());
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
    parent.at(key).refuse("each name once");
  return names;
}

constexpr const char* solid_kinds[] = {"sphere", "cylinder", "capsule", "box"};

/// Refuses what may be an obstacle or say where things are, and is not known; returns other unknown keys.
std::vector<std::string> unknown_keys_of_problem(const JsonField& problem) {
  std::set<std::string> known{"start",   "goals", "valid",       "index",
                              "problem", "name",  "description", "joint_names"};
  known.insert(std::begin(solid_kinds), std::end(solid_kinds));
  const std::set<std::string> about{"metadata",  "info",    "notes",    "tags",
                                    "goal_pose", "goal_ik", "solution", "path"};
  std::vector<std::string> unknown;
  for (const auto& [key, value] : problem.members()) {
    if (value.is_null() || known.contains(key)) continue;
    const bool is_about = about.contains(key);
    if (!is_about && (value.is_composed() || tells_of_space(key)))
      value.refuse("no such key, as what it holds would be lost, or one of " +
                   listed({known.begin(), known.end()}));
    unknown.push_back(key);
  }
  return unknown;
}

/// Whether a number or word of the file would be of all its problems: where things are, and in what units.
bool tells_of_all(const std::string& key) {
  static const std::set<std::string> telling{
      "pose", "pos",        "position", "orientation", "rotation", "rot",   "rpy",       "euler",
      "quat", "quaternion", "offset",   "origin",      "frame",    "base",  "transform", "translation",
      "unit", "units",      "scale",    "height",      "ground",   "floor", "table",     "wall"};
  std::string word;
  bool was_small = false;
  for (const char c : key) {
    const bool is_letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
    const bool is_capital = std::isupper(static_cast<unsigned char>(c)) != 0;
    if (!is_letter || (is_capital && was_small)) {  // basePose is two words
      if (telling.contains(word)) return true;
      word.clear();
    }
    if (is_letter) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    was_small = is_letter && !is_capital;
  }
  return telling.contains(word);
}

/// Of the file: what it says beside its problems. Lists and objects may be things that stand about in all.
void leave_out_rest(const JsonField& root, ForeignSet& set) {
  static const std::set<std::string> about{"metadata",   "meta",     "info",    "notes",      "tags",
                                           "repository", "config",   "configs", "statistics", "stats",
                                           "results",    "settings", "args",    "params",     "parameters",
                                           "planner",    "planners", "author",  "authors",    "license"};
  for (const auto& [key, value] : root.members()) {
    if (key == "problems" || key == "joints" || value.is_null()) continue;
    if (value.is_composed() ? !about.contains(key) : tells_of_all(key))
      value.refuse("no such key, as what it holds would be lost, or one of joints, problems");
    set.left_out.push_back(quote(key));
  }
}

/// @param joints of the file, for problems that name none
void add_problem(const std::string& experiment, std::size_t number, const JsonField& problem,
                 const std::vector<std::string>& joints, ForeignSet& set) {
  const std::string index =
      problem.has("index") ? std::to_string(problem.at("index").count()) : std::to_string(number);
  const std::string name = experiment + " " + index;
  for (const std::string& key : unknown_keys_of_problem(problem))
    set.left_out.push_back(name + ": " + quote(key));
  if (problem.has("valid") && !problem.at("valid").flag()) {
    set.left_out.push_back(name + ": it says that it is not valid");
    return;
  }
  const std::vector<JsonField> goals = problem.at("goals").items();
  if (goals.empty()) {
    set.left_out.push_back(name + ": it has no goal");
    return;
  }
  ForeignWorld world{name, {}};
  for (const char* kind : solid_kinds) add_solids(problem, kind, world, set.left_out);
  ForeignProblem ready{name, experiment, set.worlds.size(), "", {}, {}};
  const std::vector<std::string> own = joint_names(problem, "joint_names");
  const std::vector<std::string>& names = own.empty() ? joints : own;
  ready.start = state_of(problem.at("start"), names);
  for (const JsonField& goal : goals) ready.goals.push_back({state_of(goal, names)});
  set.worlds.push_back(std::move(world));
  set.problems.push_back(std::move(ready));
}

}  // namespace

ForeignSet read_problem_json(const std::string& text, const std::filesystem::path& file) {
  const std::string name = "problem set " + quote_path(file.string());
  require_json(text, name);
  const auto json = nlohmann::ordered_json::parse(text);
  const JsonField root(json, name);
  ForeignSet set;
  leave_out_rest(root, set);
  const std::vector<std::string> joints = joint_names(root, "joints");
  std::string first_fault;
  for (const auto& [experiment, list] : root.at("problems").members()) {
    std::size_t number = 0;
    for (const JsonField& problem : list.items()) {
      const std::size_t left_out = set.left_out.size();
      try {
        add_problem(experiment, ++number, problem, joints, set);
      } catch (const std::invalid_argument& fault) {
        set.left_out.resize(left_out);
        set.left_out.push_back(experiment + ", problem " + std::to_string(number) + ": " + fault.what());
        if (first_fault.empty()) first_fault = fault.what();
      }
    }
  }
  if (set.problems.empty() && !first_fault.empty()) throw std::invalid_argument(first_fault);
  return set;
}

}  // namespace clearway
