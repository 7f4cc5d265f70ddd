#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/commands.hpp"
#include "apps/inspect_parts.hpp"
#include "apps/map_page.hpp"
#include "apps/parse.hpp"
#include "apps/slice_image.hpp"
#include "mapping/map_file.hpp"
#include "mapping/save_file.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

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
  if (options.holes) json["painted_volumes"] = describe_volumes(map);
  for (const auto& [plane, file] : slices) write_slice_image(map, plane, file);
  for (const auto& file : options.exports) export_map(map, file);
  if (!options.view.empty()) save_file(options.view, map_page(map, options.map.filename().string()));

  if (console.json) {
    console.out() << json.dump(2) << '\n';
    return exit_done;
  }
  print_map(json, console.out());
  if (json.contains("at")) {
    for (const auto& point : json["at"]) print_point(point, console.out());
  }
  if (options.holes) print_volumes(json["painted_volumes"], console.out());
  for (const auto& slice : options.slices) console.out() << "  picture: " << slice.second << '\n';
  for (const auto& file : options.exports) console.out() << "  exported: " << file.string() << '\n';
  if (!options.view.empty()) console.out() << "  page: " << options.view.string() << '\n';
  return exit_done;
}

}  // namespace clearway
