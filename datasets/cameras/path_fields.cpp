#include "datasets/cameras/path_fields.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "datasets/cameras/image_size.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_values = 4'000'000;
constexpr int deepest_list = 16;
constexpr double largest_number = 1e6;

using Json = nlohmann::json;

const Json& json_of(const std::shared_ptr<const void>& value) {
  return *static_cast<const Json*>(value.get());
}

}  // namespace

void PathFields::fail(const std::string& expected) const {
  throw std::invalid_argument(where_ + ": expected " + expected);
}

bool PathFields::has(const char* key) const {
  return json_of(value_).is_object() && json_of(value_).contains(key);
}

PathFields PathFields::at(const char* key) const {
  if (!has(key)) PathFields(value_, where_ + " " + quote(key)).fail("it to be there");
  return part(&json_of(value_)[key], where_ + " " + quote(key));
}

std::vector<std::string> PathFields::keys() const {
  std::vector<std::string> keys;
  if (json_of(value_).is_object())
    for (const auto& [key, value] : json_of(value_).items()) keys.push_back(key);
  return keys;
}

std::vector<PathFields> PathFields::items() const {
  const Json& list = json_of(value_);
  if (!list.is_array()) fail("a list");
  std::vector<PathFields> items;
  for (std::size_t i = 0; i < list.size(); ++i)
    items.push_back(part(&list[i], where_ + "[" + std::to_string(i) + "]"));
  return items;
}

std::string PathFields::text() const {
  if (!json_of(value_).is_string()) fail("a text");
  return json_of(value_).get<std::string>();
}

bool PathFields::is_true() const { return json_of(value_).is_boolean() && json_of(value_).get<bool>(); }

double PathFields::number() const {
  const double number = json_of(value_).is_number() ? json_of(value_).get<double>() : NAN;
  if (!(std::abs(number) <= largest_number)) fail("a number, at most 1e6");
  return number;
}

double PathFields::time() const {
  constexpr double latest = 1e11;
  const double time = json_of(value_).is_number() ? json_of(value_).get<double>() : NAN;
  if (!(time >= 0.0 && time <= latest)) fail("a time in seconds");
  return time;
}

double PathFields::number_or(const char* key, double otherwise) const {
  return has(key) ? at(key).number() : otherwise;
}

std::vector<double> PathFields::numbers() const {
  std::vector<double> numbers;
  for (const PathFields& item : items()) {
    if (!json_of(item.value_).is_array()) {
      numbers.push_back(item.number());
      continue;
    }
    for (const PathFields& number : item.items()) numbers.push_back(number.number());
  }
  return numbers;
}

int PathFields::side() const {
  const double side = number();
  if (!(side >= 1.0 && side <= longest_side) || side != std::floor(side))
    fail("a picture of 1 to 20,000 pixels a side");
  return static_cast<int>(side);
}

PathFields PathFields::parse(const std::string& text, const std::string& name) {
  std::size_t count = 0;
  const auto look = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest_list) throw std::invalid_argument(name + ": expected lists at most 16 deep");
    if (++count > most_values) throw std::invalid_argument(name + ": expected at most 4,000,000 values");
    return true;
  };
  auto json = std::make_shared<const Json>(Json::parse(text, look, false));
  if (json->is_discarded() || !json->is_object())
    throw std::invalid_argument(name + ": expected JSON with keys and values");
  return {std::move(json), name};
}

}  // namespace clearway
