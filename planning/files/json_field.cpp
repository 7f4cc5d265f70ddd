#include "planning/files/json_field.hpp"

#include <Eigen/LU>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

JsonField::JsonField(const Json& root, std::string file)
    : JsonField(root, std::make_shared<const std::string>(std::move(file)), "") {}

JsonField::JsonField(const Json& value, std::shared_ptr<const std::string> file, std::string name)
    : value_(&value), file_(std::move(file)), name_(std::move(name)) {}

void JsonField::refuse(const std::string& expected) const { fail("expected " + expected); }

void JsonField::fail(const std::string& what) const {
  throw std::invalid_argument(*file_ + ": " + (name_.empty() ? "it" : "field '" + name_ + "'") + ": " + what);
}

std::string JsonField::inner(const std::string& key) const { return name_.empty() ? key : name_ + "." + key; }

bool JsonField::has(const char* key) const { return value_->is_object() && value_->contains(key); }

JsonField JsonField::at(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const JsonField child(has(key) ? value_->at(key) : *value_, file_, inner(key));
  if (!has(key)) child.refuse("to be there");
  return child;
}

std::vector<JsonField> JsonField::items() const {
  if (!value_->is_array()) refuse("an array");
  std::vector<JsonField> fields;
  for (std::size_t i = 0; i < value_->size(); ++i) {
    fields.push_back(item(i));
  }
  return fields;
}

std::vector<std::pair<std::string, JsonField>> JsonField::members() const {
  if (!value_->is_object()) refuse("an object");
  std::vector<std::pair<std::string, JsonField>> fields;
  for (const auto& [key, value] : value_->items())
    fields.emplace_back(key, JsonField(value, file_, inner(shortened(key))));
  return fields;
}

bool JsonField::is_composed() const { return value_->is_structured() && !value_->empty(); }

bool JsonField::is_null() const { return value_->is_null(); }

bool JsonField::is_text() const { return value_->is_string(); }

std::string JsonField::text() const {
  if (!value_->is_string()) refuse("a text");
  return value_->get<std::string>();
}

double JsonField::number() const {
  if (!value_->is_number() || !std::isfinite(value_->get<double>())) refuse("a finite number");
  return value_->get<double>();
}

std::size_t JsonField::count() const {
  if (!value_->is_number_unsigned()) refuse("a whole number >= 0");
  return value_->get<std::size_t>();
}

int JsonField::whole_number() const {
  const double value = number();
  if (value != std::round(value) || std::abs(value) > 2e9) refuse("a whole number up to 2,000,000,000");
  return static_cast<int>(value);
}

bool JsonField::flag() const {
  if (!value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
}

JsonField JsonField::item(std::size_t index) const {
  return JsonField((*value_)[index], file_, name_ + "[" + std::to_string(index) + "]");
}

Eigen::VectorXd JsonField::numbers(std::size_t size) const {
  if (!value_->is_array()) refuse("an array");
  if (value_->size() != size) {
    refuse(counted(size, "number") + ", found " + std::to_string(value_->size()));
  }
  Eigen::VectorXd result(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) result[static_cast<Eigen::Index>(i)] = item(i).number();
  return result;
}

std::vector<Eigen::VectorXd> JsonField::vectors(std::size_t size) const {
  if (!value_->is_array()) refuse("an array");
  std::vector<Eigen::VectorXd> list;
  for (std::size_t i = 0; i < value_->size(); ++i) list.push_back(item(i).numbers(size));
  return list;
}

Json json_of(const Eigen::VectorXd& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(value);
  return array;
}

Json json_of(const std::vector<Eigen::VectorXd>& list) {
  Json array = Json::array();
  for (const Eigen::VectorXd& values : list) array.push_back(json_of(values));
  return array;
}

Json json_of(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back(json_of(Eigen::VectorXd(pose.matrix().row(i))));
  return rows;
}

Eigen::Isometry3d pose_of(const JsonField& field) {
  const std::vector<JsonField> rows = field.items();
  if (rows.size() != 4) field.refuse("four rows of a homogeneous matrix");
  Eigen::Isometry3d pose;
  for (int i = 0; i < 4; ++i) pose.matrix().row(i) = rows[static_cast<std::size_t>(i)].numbers(4).transpose();
  const Eigen::Matrix3d turn = pose.linear();
  const bool is_rotation = (turn * turn.transpose()).isIdentity(1e-6) && turn.determinant() > 0.0;
  if (!is_rotation || pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    field.refuse("a rotation and a translation");
  }
  return pose;
}

Json json_of(const std::map<std::string, Policy>& policies) {
  Json json = Json::object();
  for (const auto& [part, policy] : policies) json[part] = to_string(policy);
  return json;
}

namespace {

Policy policy_of(const JsonField& field) {
  const std::string text = field.text();
  try {
    return parse_policy(text);
  } catch (const std::invalid_argument&) {
    field.refuse("painted, known_free or not_occupied, found " + quote(text));
  }
}

}  // namespace

std::map<std::string, Policy> policies_of(const JsonField& field) {
  std::map<std::string, Policy> result;
  for (const auto& [part, policy] : field.members()) result[part] = policy_of(policy);
  return result;
}

double padding_of(const JsonField& field) {
  const double padding = field.number();
  if (padding < 0.0) field.refuse("a length not below 0 (metres)");
  return padding;
}

double payload_of(const JsonField& field) {
  constexpr double greatest = 1e6;
  const double payload = field.number();
  if (!(payload >= 0.0 && payload <= greatest)) field.refuse("kg from 0 to 1000000");
  return payload;
}

Eigen::Vector3d gravity_of(const JsonField& field) {
  constexpr double greatest = 1e3;
  const Eigen::Vector3d gravity = field.numbers(3);
  if (!(gravity.norm() <= greatest)) field.refuse("a vector of at most 1000 m/s^2");
  return gravity;
}

double seen_within_of(const JsonField& field) {
  const double seconds = field.number();
  if (seconds < 0.0) field.refuse("a time not below 0 (seconds)");
  return seconds;
}

double scale_of(const JsonField& field) {
  const double scale = field.number();
  if (!(scale >= least_scale && scale <= most_scale)) field.refuse("a factor from 0.000001 to 1000");
  return scale;
}

}  // namespace clearway
