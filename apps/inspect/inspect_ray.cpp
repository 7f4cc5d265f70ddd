#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/maps/ray_states.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

Json describe_ray(const Snapshot& map, const std::string& ray) {
  const std::vector<double> numbers = parse_numbers(ray, "--ray");
  if (numbers.size() != 6)
    throw std::invalid_argument("--ray: expected OX,OY,OZ,DX,DY,DZ in metres, got '" + ray + "'");
  const Eigen::Vector3d origin(numbers[0], numbers[1], numbers[2]);
  const Eigen::Vector3d direction(numbers[3], numbers[4], numbers[5]);
  RayReport report;
  try {
    report = ray_states(map, origin, direction);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("--ray " + ray + ": " + error.what());
  }
  Json json{{"origin", to_json(origin)}, {"direction", to_json(direction.normalized())}};
  json["blocked"] = report.blocked.has_value();
  json["distance_m"] = report.distance;
  if (report.blocked) {
    json["state"] = to_string(report.blocked->state);
    json["point"] = to_json(origin + report.distance * direction.normalized());
    json["voxel_center"] = to_json(report.blocked->center);
  }
  json["runs"] = Json::array();
  for (const RayRun& run : report.runs)
    json["runs"].push_back({{"state", to_string(run.state)}, {"from_m", run.from}, {"to_m", run.to}});
  return json;
}

void print_ray(const Json& json, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> rows{{"ray from", point_text(json["origin"])},
                                                        {"direction", point_text(json["direction"])}};
  for (const auto& run : json["runs"]) {
    rows.emplace_back(run["state"].get<std::string>(),
                      length_text(run["from_m"]) + " to " + length_text(run["to_m"]));
  }
  if (json["blocked"].get<bool>()) {
    rows.emplace_back("blocked at", length_text(json["distance_m"]) + ": " +
                                        json["state"].get<std::string>() + ", voxel at " +
                                        point_text(json["voxel_center"]));
  } else {
    rows.emplace_back("blocked at", "nowhere up to the end of the map");
  }
  out << '\n';
  print_rows(out, rows);
}

}  // namespace clearway
