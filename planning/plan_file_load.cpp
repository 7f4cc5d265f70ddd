#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "planning/plan_file.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

/// One value of the file with its name, so that every complaint can say where it is.
class Field {
 public:
  Field(const Json& value, std::string file, std::string name)
      : value_(&value), file_(std::move(file)), name_(std::move(name)) {}

  [[noreturn]] void refuse(const std::string& expected) const {
    throw std::invalid_argument("plan file " + file_ + ": " +
                                (name_.empty() ? "it" : "field '" + name_ + "'") + ": expected " + expected);
  }

  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  Field at(const char* key) const {
    if (!value_->is_object()) refuse("an object");
    const Field child(has(key) ? value_->at(key) : *value_, file_, name_.empty() ? key : name_ + "." + key);
    if (!has(key)) child.refuse("to be there");
    return child;
  }
  std::vector<Field> items() const {
    if (!value_->is_array()) refuse("an array");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < value_->size(); ++i) {
      fields.emplace_back((*value_)[i], file_, name_ + "[" + std::to_string(i) + "]");
    }
    return fields;
  }
  std::vector<std::pair<std::string, Field>> members() const {
    if (!value_->is_object()) refuse("an object");
    std::vector<std::pair<std::string, Field>> fields;
    for (const auto& [key, value] : value_->items())
      fields.emplace_back(key, Field(value, file_, name_ + "." + key));
    return fields;
  }

  bool is_null() const { return value_->is_null(); }
  std::string text() const {
    if (!value_->is_string()) refuse("a text");
    return value_->get<std::string>();
  }
  double number() const {
    if (!value_->is_number() || !std::isfinite(value_->get<double>())) refuse("a finite number");
    return value_->get<double>();
  }
  std::uint64_t count() const {
    if (!value_->is_number_unsigned()) refuse("a whole number >= 0");
    return value_->get<std::uint64_t>();
  }
  bool flag() const {
    if (!value_->is_boolean()) refuse("true or false");
    return value_->get<bool>();
  }

 private:
  const Json* value_;
  std::string file_, name_;
};

Configuration numbers(const Field& field, std::size_t size) {
  const std::vector<Field> items = field.items();
  if (items.size() != size) {
    field.refuse(std::to_string(size) + " numbers, found " + std::to_string(items.size()));
  }
  Configuration values(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) values[static_cast<Eigen::Index>(i)] = items[i].number();
  return values;
}

std::vector<Configuration> path(const Field& field, std::size_t dof) {
  std::vector<Configuration> configurations;
  for (const Field& item : field.items()) configurations.push_back(numbers(item, dof));
  return configurations;
}

PlanStatus status(const Field& field) {
  const std::string text = field.text();
  for (const PlanStatus known : {PlanStatus::solved, PlanStatus::start_invalid, PlanStatus::goal_invalid,
                                 PlanStatus::no_path, PlanStatus::timed_out}) {
    if (text == to_string(known)) return known;
  }
  field.refuse("solved, start_invalid, goal_invalid, no_path or timed_out, found '" + text + "'");
}

std::map<std::string, Policy> policies(const Field& field) {
  std::map<std::string, Policy> result;
  for (const auto& [part, policy] : field.members()) {
    try {
      result[part] = parse_policy(policy.text());
    } catch (const std::invalid_argument& error) {
      policy.refuse(error.what());
    }
  }
  return result;
}

Eigen::Isometry3d base(const Field& field) {
  const std::vector<Field> rows = field.items();
  if (rows.size() != 4) field.refuse("four rows of a homogeneous matrix");
  Eigen::Isometry3d pose;
  for (int i = 0; i < 4; ++i)
    pose.matrix().row(i) = numbers(rows[static_cast<std::size_t>(i)], 4).transpose();
  const Eigen::Matrix3d turn = pose.linear();
  const bool is_rotation = (turn * turn.transpose()).isIdentity(1e-6) && turn.determinant() > 0.0;
  if (!is_rotation || pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    field.refuse("a rotation and a translation");
  }
  return pose;
}

/// The leg's share of the whole path: "waypoints": [first, last], both included.
std::vector<Configuration> share(const Field& field, const std::vector<Configuration>& whole) {
  const std::vector<Field> ends = field.items();
  if (ends.size() != 2) field.refuse("the first and the last index of the leg's waypoints");
  const std::uint64_t first = ends[0].count(), last = ends[1].count();
  if (first > last || last >= whole.size()) {
    field.refuse("indices of the " + std::to_string(whole.size()) + " waypoints, first <= last");
  }
  return {whole.begin() + static_cast<std::ptrdiff_t>(first),
          whole.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

PlanResult leg(const Field& field, const std::vector<Configuration>& whole, std::size_t dof) {
  PlanResult result;
  result.status = status(field.at("status"));
  result.explanation = field.at("explanation").text();
  const Field waypoints = field.at("waypoints");
  if (!waypoints.is_null()) result.waypoints = share(waypoints, whole);
  const bool has_path = !result.waypoints.empty();
  if (has_path != (result.status == PlanStatus::solved)) waypoints.refuse("waypoints exactly when solved");
  if (field.has("explored")) result.explored = path(field.at("explored"), dof);
  result.cost = field.at("cost_joules").number();
  result.search_steps = static_cast<int>(field.at("search_steps").count());
  if (field.has("last_segment")) result.last_segment = field.at("last_segment").flag();
  if (field.has("last_segment_joules")) result.last_segment_cost = field.at("last_segment_joules").number();
  if (field.has("final_distance_rad")) result.final_distance = field.at("final_distance_rad").number();
  if (field.has("checks")) result.configurations_checked = field.at("checks").count();
  if (field.has("edges_checked")) result.edges_checked = field.at("edges_checked").count();
  if (!field.has("statistics")) return result;
  for (const auto& [name, value] : field.at("statistics").members()) result.statistics[name] = value.number();
  return result;
}

PathVerdict validation(const Field& field) {
  PathVerdict result;
  const std::string verdict = field.at("verdict").text();
  if (verdict != "valid" && verdict != "undecided" && verdict != "refused" && verdict != "not_checked") {
    field.at("verdict").refuse("valid, undecided, refused or not_checked");
  }
  result.valid = verdict == "valid";
  result.undecided = verdict == "undecided";
  result.min_clearance = field.at("min_clearance_m").number();
  result.checker = field.at("checker").text();
  if (field.has("first_contact")) result.first_contact = field.at("first_contact").text();
  if (field.has("edge")) result.edge = static_cast<int>(field.at("edge").number());
  if (field.has("parameter")) result.parameter = field.at("parameter").number();
  if (!field.has("clearance_m")) return result;
  for (const Field& item : field.at("clearance_m").items()) result.clearance.push_back(item.number());
  return result;
}

PaintHint paint_hint(const Field& field) {
  PaintHint hint;
  hint.part = field.at("part").text();
  hint.ball.center = numbers(field.at("center"), 3);
  hint.ball.radius = field.at("radius").number();
  if (!(hint.ball.radius > 0.0)) field.at("radius").refuse("a number above 0");
  return hint;
}

Plan read_plan(const Field& root) {
  Plan plan;
  plan.robot = root.at("robot").text();
  for (const Field& joint : root.at("joints").items()) plan.joints.push_back(joint.text());
  if (plan.joints.empty()) root.at("joints").refuse("at least one joint");
  const std::size_t dof = plan.joints.size();
  plan.planner = root.at("planner").text();
  for (const auto& [name, value] : root.at("options").members()) plan.options[name] = value.text();
  plan.seed = root.at("seed").count();
  plan.map_file = root.at("map").at("file").text();
  plan.map_sha256 = root.at("map").at("sha256").text();
  plan.map_resolution = root.at("map").at("resolution").number();
  plan.policies = policies(root.at("policy"));
  status(root.at("status"));
  const std::vector<Configuration> whole = path(root.at("waypoints"), dof);
  for (const Field& item : root.at("legs").items()) plan.legs.push_back(leg(item, whole, dof));
  if (plan.status() != status(root.at("status"))) root.at("status").refuse("the status of the legs");
  if (plan.waypoints() != whole) root.at("legs").refuse("legs that make up all waypoints");
  plan.time_s = root.at("time_s").number();
  plan.validation = validation(root.at("validation"));
  if (root.has("goals")) plan.goals = path(root.at("goals"), dof);
  if (root.has("scale")) plan.robot_scale = root.at("scale").number();
  if (!(plan.robot_scale > 0.0)) root.at("scale").refuse("a number above 0");
  if (root.has("base")) plan.map_from_base = base(root.at("base"));
  if (root.has("padding_m")) plan.padding = root.at("padding_m").number();
  if (root.has("payload_kg")) plan.payload = root.at("payload_kg").number();
  if (root.has("gravity")) plan.gravity = numbers(root.at("gravity"), 3);
  if (!root.has("paint")) return plan;
  for (const Field& item : root.at("paint").items()) plan.paint.push_back(paint_hint(item));
  return plan;
}

}  // namespace

Plan load_plan(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream.is_open() || !std::filesystem::is_regular_file(file)) {
    throw std::invalid_argument("plan file " + file.string() + ": cannot be read as a file");
  }
  const std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  Json json;
  try {
    json = Json::parse(content);
  } catch (const Json::exception& error) {
    throw std::invalid_argument("plan file " + file.string() + ": not JSON: " + error.what());
  }
  return read_plan(Field(json, file.string(), ""));
}

}  // namespace clearway
