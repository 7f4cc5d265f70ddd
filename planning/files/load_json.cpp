#include "planning/files/load_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json numbers_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

constexpr double largest = 1e6;  ///< m, as in files by hand

/// A number, or a refusal of what is no length or place.
double length_of(double value, const JsonField& field) {
  if (!(std::abs(value) <= largest)) field.refuse("lengths of at most 1e6 m");
  return value;
}

Eigen::VectorXd lengths_of(const Eigen::VectorXd& values, const JsonField& field) {
  for (const double value : values) length_of(value, field);
  return values;
}

Eigen::Isometry3d place_of(const JsonField& field) {
  const Eigen::Isometry3d pose = pose_of(field);
  lengths_of(pose.translation(), field);
  return pose;
}

Shape sized_shape(const ShapeSizes& kind, const JsonField& field) {
  const JsonField sizes = field.at(kind.name);
  const Eigen::VectorXd values = kind.count == 1
                                     ? Eigen::VectorXd(Eigen::VectorXd::Constant(1, sizes.number()))
                                     : sizes.numbers(static_cast<std::size_t>(kind.count));
  lengths_of(values, field);
  return Shape::of_sizes(kind.name, {values.data(), static_cast<std::size_t>(values.size())});
}

Shape read_shape(const JsonField& field) {
  int kinds = field.has("hull") ? 1 : 0;
  for (const ShapeSizes& kind : Shape::sized_kinds()) kinds += field.has(kind.name) ? 1 : 0;
  if (kinds > 1) field.refuse("one of sphere, capsule, cylinder, box and hull, found several");
  for (const ShapeSizes& kind : Shape::sized_kinds())
    if (field.has(kind.name)) return sized_shape(kind, field);
  if (!field.has("hull")) field.refuse("sphere, capsule, cylinder, box or hull");
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::VectorXd& corner : field.at("hull").vectors(3))
    corners.emplace_back(lengths_of(corner, field));
  return Shape::convex(std::move(corners));
}

LegLoad read_load(const JsonField& field) {
  LegLoad load;
  load.load.name = field.at("name").text();
  load.load.link = field.at("link").text();
  load.load.link_from_load = place_of(field.at("pose"));
  load.load.shape = shape_of(field.at("shape"));
  load.load.mass = field.at("mass_kg").number();
  for (const JsonField& link : field.at("touches").items()) load.load.touches.push_back(link.text());
  if (!field.has("legs")) return load;
  for (const JsonField& leg : field.at("legs").items()) {
    if (leg.whole_number() < 1) leg.refuse("a number of a leg, from 1");
    load.legs.push_back(leg.whole_number() - 1);
  }
  if (load.legs.empty()) field.at("legs").refuse("at least one leg");
  return load;
}

}  // namespace

Json json_of(const Shape& shape) {
  const std::vector<double> sizes = shape.sizes();
  if (sizes.size() == 1) return {{shape.name(), sizes.front()}};
  if (!sizes.empty()) return {{shape.name(), sizes}};
  Json hull = Json::array();
  for (const Eigen::Vector3d& corner : shape.vertices()) hull.push_back(numbers_of(corner));
  return {{"hull", std::move(hull)}};
}

Shape shape_of(const JsonField& field) {
  std::string wrong;
  try {
    return read_shape(field);
  } catch (const std::invalid_argument& error) {
    wrong = error.what();
  }
  if (wrong.find("field '") != std::string::npos) throw std::invalid_argument(wrong);
  field.refuse("a shape of some size, found one of which " + wrong);
}

Json json_of(const std::vector<LegLoad>& loads) {
  Json list = Json::array();
  for (const LegLoad& load : loads) {
    Json json = {{"name", load.load.name},
                 {"link", load.load.link},
                 {"pose", json_of(load.load.link_from_load)},
                 {"shape", json_of(load.load.shape)},
                 {"mass_kg", load.load.mass},
                 {"touches", load.load.touches}};
    for (const int leg : load.legs) json["legs"].push_back(leg + 1);
    list.push_back(std::move(json));
  }
  return list;
}

Json json_of(const Pick& pick) {
  Json json = {{"name", pick.object.name},
               {"link", pick.object.link},
               {"shape", json_of(pick.object.shape)},
               {"mass_kg", pick.object.mass},
               {"touches", pick.object.touches},
               {"pose", json_of(pick.map_from_object)},
               {"place", json_of(pick.map_from_place)},
               {"grasp", json_of(pick.object_from_tip)},
               {"approach", numbers_of(pick.approach)},
               {"lift_m", pick.lift},
               {"contact_m", pick.contact},
               {"margin_m", pick.margin}};
  if (!pick.grip.empty()) json["depth_m"] = pick.depth;
  for (const auto& [joint, grip] : pick.grip) json["grip"][joint] = {grip.open, grip.closed};
  return json;
}

Pick pick_of(const JsonField& field) {
  Pick pick;
  pick.object.name = field.at("name").text();
  pick.object.link = field.at("link").text();
  pick.object.shape = shape_of(field.at("shape"));
  pick.object.mass = field.at("mass_kg").number();
  for (const JsonField& link : field.at("touches").items()) pick.object.touches.push_back(link.text());
  pick.map_from_object = place_of(field.at("pose"));
  pick.map_from_place = place_of(field.at("place"));
  pick.object_from_tip = place_of(field.at("grasp"));
  pick.approach = field.at("approach").numbers(3);
  pick.lift = field.at("lift_m").number();
  pick.contact = field.at("contact_m").number();
  pick.margin = field.at("margin_m").number();
  if (field.has("depth_m")) pick.depth = field.at("depth_m").number();
  if (field.has("grip"))
    for (const auto& [joint, values] : field.at("grip").members()) {
      const Eigen::VectorXd both = values.numbers(2);
      pick.grip[joint] = {both[0], both[1]};
    }
  return pick;
}

std::vector<LegLoad> loads_of(const JsonField& field) {
  std::vector<LegLoad> loads;
  for (const JsonField& item : field.items()) loads.push_back(read_load(item));
  return loads;
}

}  // namespace clearway
