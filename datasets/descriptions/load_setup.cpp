#include "datasets/descriptions/load_setup.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "datasets/descriptions/setup.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

namespace {

constexpr Bounds sizes{1e-6, 1e3};    ///< metres, as of a robot's bodies
constexpr Bounds factors{1e-6, 1e6};  ///< of meshes, the same

/// A file of points: three numbers a line.
std::vector<Eigen::Vector3d> points_of_file(const std::filesystem::path& file) {
  const std::string text = read_input(file, "hull", 16U << 20U);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t at = 0, line = 1; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const char *begin = text.data() + at, *const stop = text.data() + end;
    Eigen::Vector3d point;
    for (double& value : point) {
      while (begin != stop && (*begin == ' ' || *begin == '\t')) ++begin;
      const auto [after, error] = std::from_chars(begin, stop, value);
      const bool is_number = error == std::errc() && std::abs(value) <= within_reach.high &&
                             (after == stop || *after == ' ' || *after == '\t' || *after == '\r');
      if (!is_number)
        throw std::invalid_argument("hull " + quote_path(file.string()) + ", line " + std::to_string(line) +
                                    ": expected three numbers from -1000000 to 1000000.");
      begin = after;
    }
    if (std::string_view(begin, stop).find_first_not_of(" \t\r") != std::string_view::npos)
      throw std::invalid_argument("hull " + quote_path(file.string()) + ", line " + std::to_string(line) +
                                  ": expected three numbers, got more.");
    points.push_back(point);
    at = end + 1;
  }
  return points;
}

LoadHull read_hull(const YamlFields& fields, const std::filesystem::path& folder) {
  LoadHull hull;
  if (fields.is_list("hull"))
    for (const auto& point : fields.lists_of_numbers("hull", within_reach, 3))
      hull.points.emplace_back(point.data());
  else
    hull.points = points_of_file(folder / fields.file("hull"));
  constexpr std::size_t most = 100'000;
  if (hull.points.empty() || hull.points.size() > most)
    fields.fail("hull", "expected 1 to " + std::to_string(most) + " points");
  return hull;
}

/// Of three numbers the object keeps its attitude.
Eigen::Isometry3d place_of(const YamlFields& fields, const Eigen::Isometry3d& map_from_object) {
  const std::string key = fields.has("place_deg") ? "place_deg" : "place";
  const std::size_t count = fields.is_list(key) ? fields.numbers(key, within_reach).size() : 6;
  if (count != 3 && count != 6)
    fields.fail(key, "expected x, y, z or x, y, z, roll, pitch, yaw, got " + counted(count, "number"));
  if (count == 6) return fields.pose("place");
  Eigen::Isometry3d place = map_from_object;
  place.translation() = fields.vector(key);
  return place;
}

}  // namespace

LoadShape read_load_shape(const YamlFields& fields, const std::filesystem::path& folder) {
  const int kinds = fields.has("box") + fields.has("cylinder") + fields.has("capsule") +
                    fields.has("sphere") + fields.has("mesh") + fields.has("hull");
  if (kinds != 1)
    fields.fail("name", "expected exactly one of box, cylinder, capsule, sphere, mesh and hull");
  if (fields.has("box")) return LoadBox{Eigen::Vector3d(fields.numbers("box", sizes, 3).data())};
  if (fields.has("sphere")) return LoadSphere{fields.number("sphere", sizes)};
  if (fields.has("mesh")) return LoadMesh{folder / fields.file("mesh"), fields.number("scale", factors, 1)};
  if (fields.has("hull")) return read_hull(fields, folder);
  const bool is_capsule = fields.has("capsule");
  const auto size = fields.numbers(is_capsule ? "capsule" : "cylinder", sizes, 2);
  if (is_capsule) return LoadCapsule{size[0], size[1]};
  return LoadCylinder{size[0], size[1]};
}

LoadSetup read_load(const YamlFields& fields, const std::filesystem::path& folder) {
  LoadSetup load;
  load.name = fields.text("name");
  load.shape = read_load_shape(fields, folder);
  load.link = fields.text("link");
  load.link_from_load = fields.pose("pose", load.link_from_load);
  load.mass = fields.number("mass", not_negative, 0);
  load.touches = fields.texts("touches");
  if (fields.has("legs")) {
    for (const double leg : fields.numbers("legs", {1, 1000})) {
      load.legs.push_back(static_cast<int>(leg));
      if (load.legs.back() != leg) fields.fail("legs", "expected numbers of legs: 1, 2, …");
    }
    if (load.legs.empty()) fields.fail("legs", "expected at least one leg, or no such key");
  }
  fields.finish();
  return load;
}

LoadSetup load_load(const std::filesystem::path& file) {
  return read_load(YamlFields(read_text(file, "a load"), "load " + quote_path(file.string())),
                   file.parent_path());
}

PickSetup read_pick(const YamlFields& fields, const std::filesystem::path& folder) {
  PickSetup pick;
  pick.name = fields.text("name");
  pick.shape = read_load_shape(fields, folder);
  pick.link = fields.text("link");
  pick.mass = fields.number("mass", not_negative, 0);
  pick.touches = fields.texts("touches");
  pick.map_from_object = fields.pose("pose");
  if (fields.has_angles("place")) pick.map_from_place = place_of(fields, pick.map_from_object);
  pick.object_from_tip = fields.pose("grasp");
  if (fields.has("approach")) pick.approach = fields.vector("approach");
  pick.lift = fields.number("lift", above_zero, pick.lift);
  pick.contact = fields.number("contact", not_negative, pick.contact);
  pick.margin = fields.number("margin", not_negative, pick.margin);
  pick.depth = fields.number("depth", not_negative, pick.depth);
  if (fields.names("grip")) {
    const YamlFields grip = fields.map("grip");
    if (grip.keys().empty()) fields.fail("grip", "expected {joint: [open, closed]}, or no such key");
    for (const std::string& joint : grip.keys()) {
      const std::vector<double> values = grip.numbers(joint, {-1e6, 1e6}, 2);
      pick.grip[joint] = {values[0], values[1]};
    }
  }
  fields.finish();
  return pick;
}

PickSetup load_pick(const std::filesystem::path& file) {
  return read_pick(YamlFields(read_text(file, "a pick"), "pick " + quote_path(file.string())),
                   file.parent_path());
}

}  // namespace clearway
