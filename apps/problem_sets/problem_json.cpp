#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/planning_scene.hpp"
#include "datasets/descriptions/yaml_fields.hpp"
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

/// Position, and a turn as a quaternion or as angles about the fixed axes x, y, z.
Eigen::Isometry3d pose_of_object(const JsonField& object) {
  const Eigen::Vector3d position = object.at("position").numbers(3);
  if (position.cwiseAbs().maxCoeff() > 1e3) object.at("position").refuse("a place within 1000 metres");
  if (object.has("orientation_quat_xyzw")) {
    try {
      return pose_of_quaternion(position, object.at("orientation_quat_xyzw").numbers(4));
    } catch (const std::invalid_argument&) {
      object.at("orientation_quat_xyzw").refuse("a unit quaternion x, y, z, w");
    }
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position;
  if (!object.has("orientation_euler_xyz")) return pose;
  const Eigen::VectorXd turn = object.at("orientation_euler_xyz").numbers(3);
  pose.linear() = rotation_from_rpy(turn[0], turn[1], turn[2]);
  return pose;
}

void add_solids(const JsonField& problem, const char* kind, ForeignWorld& world) {
  if (!problem.has(kind)) return;
  std::size_t number = 0;
  for (const JsonField& object : problem.at(kind).items()) {
    ForeignSolid solid;
    solid.kind = kind;
    ++number;
    solid.object = object.has("name") ? object.at("name").text() : kind + std::to_string(number);
    solid.map_from_shape = pose_of_object(object);
    if (solid.kind == "sphere") {
      solid.shape = Shape::sphere(length_of(object.at("radius")));
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

void add_problem(const std::string& experiment, std::size_t number, const JsonField& problem,
                 ForeignSet& set) {
  const std::string index =
      problem.has("index") ? std::to_string(problem.at("index").count()) : std::to_string(number);
  const std::string name = experiment + " " + index;
  for (const auto& [key, value] : problem.members()) {
    const std::set<std::string> known{"sphere", "cylinder", "box",  "start", "goals",      "valid",
                                      "index",  "problem",  "name", "robot", "description"};
    if (!value.is_null() && !known.contains(key)) set.left_out.push_back(name + ": " + quote(key));
  }
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
  for (const char* kind : {"sphere", "cylinder", "box"}) add_solids(problem, kind, world);
  ForeignProblem ready{name, experiment, set.worlds.size(), "", {}, {}};
  ready.start.values = values_of(problem.at("start"));
  for (const JsonField& goal : goals) ready.goals.push_back({{{}, values_of(goal)}});
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
  for (const auto& [experiment, list] : root.at("problems").members()) {
    std::size_t number = 0;
    for (const JsonField& problem : list.items()) add_problem(experiment, ++number, problem, set);
  }
  return set;
}

}  // namespace clearway
