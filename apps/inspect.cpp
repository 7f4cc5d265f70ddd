#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/commands.hpp"
#include "apps/map_page.hpp"
#include "apps/parse.hpp"
#include "apps/slice_image.hpp"
#include "apps/table.hpp"
#include "mapping/map_file.hpp"
#include "mapping/save_file.hpp"

namespace clearway {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json describe_map(const InspectOptions& options, const Snapshot& map) {
  const VoxelCounts counts = map.counts();
  const double voxel_volume = std::pow(map.resolution(), 3);
  Json json;
  json["map"] = options.map.string();
  json["sha256"] = map_sha256(options.map);
  json["resolution"] = map.resolution();
  json["voxels"] = {{"painted", counts.painted},
                    {"seen_free", counts.seen_free},
                    {"occupied", counts.occupied},
                    {"conflict", counts.conflict}};
  if (!map.bounds().isEmpty()) {
    json["bounds"] = {{"min", to_json(map.bounds().min())}, {"max", to_json(map.bounds().max())}};
  }
  json["painted_volume_m3"] = static_cast<double>(counts.painted) * voxel_volume;
  json["volumes"] = Json::array();
  for (const PaintedVolume& volume : map.volumes()) {
    json["volumes"].push_back(
        {{"label", volume.label}, {"critical_parts", volume.critical_parts}, {"balls", volume.balls.size()}});
  }
  return json;
}

/// The state of one voxel, why, and how far the nearest blocked voxels are.
Json describe_point(const Snapshot& map, const Eigen::Vector3d& point) {
  const Voxel voxel = map.voxel(point);
  Json json{{"point", to_json(point)}, {"state", to_string(voxel.state)}, {"observed", voxel.observed}};
  if (voxel.observed) {
    json["log_odds"] = voxel.log_odds;
    json["probability"] = 1.0 - 1.0 / (1.0 + std::exp(voxel.log_odds));
  }
  json["voxel_center"] = to_json(voxel.center);
  json["voxel_size"] = voxel.size;
  json["painted_by"] = Json::array();
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    if ((voxel.volumes >> v & 1) != 0) json["painted_by"].push_back(map.volumes()[v].label);
  }
  json["inside_exact_balls"] = Json::array();
  for (const PaintedVolume& volume : map.volumes()) {
    if (volume.contains(point)) json["inside_exact_balls"].push_back(volume.label);
  }
  const double reach = 40.0 * map.resolution();
  const Eigen::AlignedBox3d region(point - Eigen::Vector3d::Constant(reach),
                                   point + Eigen::Vector3d::Constant(reach));
  for (const Policy policy : {Policy::not_occupied, Policy::known_free, Policy::painted}) {
    json["clearance_m"][std::string(to_string(policy))] =
        map.blocked_space({policy, 0xffff}, region, reach)->clearance(point);
  }
  json["clearance_capped_at_m"] = reach;
  return json;
}

std::string join(const Json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text.empty() ? "-" : text;
}

std::string millimetres(const Json& metres) { return significant(metres.get<double>() * 1000.0, 4) + " mm"; }

void print_map(const Json& json, const Snapshot& map, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> rows{{"map", json["map"].get<std::string>()},
                                                        {"resolution", millimetres(json["resolution"])}};
  if (json.contains("bounds")) {
    const Eigen::AlignedBox3d box = map.bounds();
    const char* names[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      rows.emplace_back(names[axis],
                        significant(box.min()[axis]) + " to " + significant(box.max()[axis]) + " m");
    }
  }
  for (const auto& [state, count] : json["voxels"].items())
    rows.emplace_back(state, grouped(count.get<std::size_t>()));
  for (const auto& volume : json["volumes"]) {
    rows.emplace_back(
        "volume " + volume["label"].get<std::string>(),
        grouped(volume["balls"].get<std::size_t>()) + " balls, parts: " + join(volume["critical_parts"]));
  }
  print_rows(out, rows);
}

void print_point(const Json& json, std::ostream& out) {
  const auto& p = json["point"];
  std::vector<std::pair<std::string, std::string>> rows{
      {"at", significant(p[0].get<double>(), 6) + ", " + significant(p[1].get<double>(), 6) + ", " +
                 significant(p[2].get<double>(), 6)},
      {"state", json["state"].get<std::string>()}};
  if (json["observed"].get<bool>()) {
    rows.emplace_back("sensors", "probability " + significant(json["probability"].get<double>(), 3) +
                                     " (log-odds " + significant(json["log_odds"].get<double>(), 3) + ")");
  } else {
    rows.emplace_back("sensors", "never observed");
  }
  rows.emplace_back("painted by", join(json["painted_by"]));
  rows.emplace_back("inside exact balls of", join(json["inside_exact_balls"]));
  for (const auto& [policy, metres] : json["clearance_m"].items()) {
    rows.emplace_back("clearance, " + policy, ">= " + millimetres(metres));
  }
  out << '\n';
  print_rows(out, rows);
}

}  // namespace

int run_inspect(const InspectOptions& options, Console& console) {
  std::vector<std::pair<SlicePlane, std::filesystem::path>> slices;
  for (const auto& [plane, file] : options.slices) slices.emplace_back(parse_slice(plane), file);
  std::vector<Eigen::Vector3d> points;
  for (const std::string& text : options.at) {
    const auto numbers = parse_numbers(text, "--at");
    if (numbers.size() != 3)
      throw std::invalid_argument("--at: expected X,Y,Z in metres, got '" + text + "'");
    points.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  const Snapshot map = load_map(options.map);
  const double farthest = 32000.0 * map.resolution();  // OctoMap's keys end at 32,768 voxels
  for (const Eigen::Vector3d& point : points) {
    if (point.cwiseAbs().maxCoeff() > farthest) {
      throw std::invalid_argument("--at: " + significant(point.cwiseAbs().maxCoeff()) +
                                  " m is beyond what a map of this resolution can hold, " +
                                  significant(farthest) + " m");
    }
  }

  Json json = describe_map(options, map);
  for (const Eigen::Vector3d& point : points) json["at"].push_back(describe_point(map, point));
  for (const auto& [plane, file] : slices) write_slice_image(map, plane, file);
  for (const auto& file : options.exports) export_map(map, file);
  if (!options.view.empty()) save_file(options.view, map_page(map, options.map.filename().string()));

  if (console.json) {
    console.out() << json.dump(2) << '\n';
    return exit_done;
  }
  print_map(json, map, console.out());
  if (json.contains("at")) {
    for (const auto& point : json["at"]) print_point(point, console.out());
  }
  for (const auto& slice : options.slices) console.out() << "  picture: " << slice.second << '\n';
  for (const auto& file : options.exports) console.out() << "  exported: " << file.string() << '\n';
  if (!options.view.empty()) console.out() << "  page: " << options.view.string() << '\n';
  return exit_done;
}

}  // namespace clearway
