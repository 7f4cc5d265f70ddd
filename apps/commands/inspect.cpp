#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/parse.hpp"
#include "apps/inspect/inspect_bag.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "apps/inspect/slice_image.hpp"
#include "apps/pages/map_page.hpp"
#include "datasets/ros/bag_source.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

std::vector<Eigen::Vector3d> points_of(const std::vector<std::string>& texts) {
  std::vector<Eigen::Vector3d> points;
  for (const std::string& text : texts) {
    const auto numbers = parse_numbers(text, "--at");
    if (numbers.size() != 3)
      throw std::invalid_argument("--at: expected X,Y,Z in metres, got '" + text + "'");
    points.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  return points;
}

void require_in_reach(const std::vector<Eigen::Vector3d>& points, const Snapshot& map) {
  const double farthest = 32000.0 * map.resolution();  // OctoMap's keys end at 32,768 voxels
  for (const Eigen::Vector3d& point : points) {
    if (point.cwiseAbs().maxCoeff() <= farthest) continue;
    throw std::invalid_argument("--at: " + significant(point.cwiseAbs().maxCoeff()) +
                                " m is beyond what a map of this resolution can hold, " +
                                significant(farthest) + " m");
  }
}

/// What replay wrote beside the map; none for a map that was edited since, with a word about it.
std::optional<Provenance> provenance_of(const InspectOptions& options, Console& console) {
  if (!options.save.empty() || (options.at.empty() && !options.conflicts)) return std::nullopt;
  std::optional<Provenance> found = load_provenance(options.map);
  if (!found && options.conflicts)
    throw std::invalid_argument("--conflicts: " + options.map.string() +
                                " holds no provenance.bin, expected a folder written by replay");
  if (found && found->map_sha256 != map_sha256(options.map)) {
    console.warn("warning: provenance.bin belongs to another map and is not used");
    return std::nullopt;
  }
  return found;
}

void print_text(const InspectOptions& options, const Json& json, Console& console) {
  print_map(json, console.out());
  if (json.contains("at"))
    for (const auto& point : json["at"]) print_point(point, console.out());
  if (json.contains("rays"))
    for (const auto& ray : json["rays"]) print_ray(ray, console.out());
  if (json.contains("conflicts")) print_conflicts(json["conflicts"], console.out());
  if (json.contains("diff")) print_difference(json["diff"], console.out());
  if (options.holes) print_volumes(json["painted_volumes"], console.out());
  for (const auto& slice : options.slices) console.out() << "  picture: " << slice.second << '\n';
  for (const auto& file : options.exports) console.out() << "  exported: " << file.string() << '\n';
  if (!options.view.empty()) console.out() << "  page: " << options.view.string() << '\n';
  if (!options.save.empty()) console.out() << "  saved: " << options.save.string() << '\n';
}

}  // namespace

int run_inspect(const InspectOptions& options, Console& console) {
  if (is_bag_file(options.map)) return inspect_bag(options, console);
  std::vector<std::pair<SlicePlane, std::filesystem::path>> slices;
  for (const auto& [plane, file] : options.slices) slices.emplace_back(parse_slice(plane), file);
  std::optional<Policy> lines;
  if (!options.clearance.empty()) lines = parse_policy(options.clearance);
  if (lines && slices.empty())
    throw std::invalid_argument("--clearance: expected --slice beside it, in which to draw the lines");
  if (options.age && slices.empty())
    throw std::invalid_argument("--age: expected --slice beside it, which it colours");
  const std::vector<Eigen::Vector3d> points = points_of(options.at);
  // Everything is read before anything is said; see hand_over.cpp.
  const Snapshot loaded = load_map(options.map);
  const Snapshot map = edited(options, loaded);
  std::optional<Snapshot> other;
  if (!options.diff.empty()) other = load_map(options.diff);
  if (const std::string remark = painted_csv_remark(options.map, loaded); !remark.empty())
    console.warn("note: " + remark);
  require_in_reach(points, map);
  for (const auto& [plane, file] : slices) require_writable(file);
  for (const auto& file : options.exports) require_writable(file);
  if (!options.view.empty()) require_writable(options.view);
  const std::optional<Provenance> provenance = provenance_of(options, console);

  Json json = describe_map(options, map);
  for (const Eigen::Vector3d& point : points)
    json["at"].push_back(describe_point(map, provenance ? &*provenance : nullptr, point));
  for (const std::string& ray : options.rays) json["rays"].push_back(describe_ray(map, ray));
  if (options.conflicts && provenance) json["conflicts"] = describe_conflicts(*provenance);
  if (other) json["diff"] = describe_difference(map, *other, options.diff);
  if (options.holes) json["painted_volumes"] = describe_volumes(map);
  for (const auto& [plane, file] : slices) write_slice_image(map, plane, file, lines, options.age);
  for (const auto& file : options.exports) export_map(map, file);
  if (!options.view.empty()) save_file(options.view, map_page(map, options.map.filename().string()));
  if (!options.save.empty()) {
    save_edited(options, map);
    json["saved"] = options.save.string();
  }

  if (console.json) {
    console.out() << json.dump(2) << '\n';
  } else {
    print_text(options, json, console);
  }
  return json.contains("diff") && json["diff"]["differ"].get<bool>() ? exit_no : exit_done;
}

}  // namespace clearway
