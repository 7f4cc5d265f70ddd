#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/maps/map_difference.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

Json describe_difference(const Snapshot& map, const Snapshot& there, const std::filesystem::path& other) {
  const MapDifference found = difference(map, there);
  Json json{{"map", other.string()}, {"differ", found.any()}};
  json["resolution"] = {
      {"differs", found.resolution}, {"here", map.resolution()}, {"there", there.resolution()}};
  json["threshold_differs"] = found.threshold;
  json["volumes"] = found.volumes;
  json["voxels"] = Json::array();
  for (const auto& [states, count] : found.states)
    json["voxels"].push_back(
        {{"here", to_string(states.first)}, {"there", to_string(states.second)}, {"count", count}});
  json["same_state_other_evidence"] = found.evidence;
  return json;
}

void print_difference(const Json& json, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> rows{
      {"compared with", json["map"].get<std::string>()},
      {"the maps", json["differ"].get<bool>() ? "differ" : "are equal"}};
  const Json& resolution = json["resolution"];
  if (resolution["differs"].get<bool>()) {
    rows.emplace_back("resolution", length_text(resolution["here"]) + " here, " +
                                        length_text(resolution["there"]) + " there: voxels not compared");
  }
  if (json["threshold_differs"].get<bool>())
    rows.emplace_back("threshold", "occupied from another probability on");
  for (const auto& label : json["volumes"])
    rows.emplace_back("volume " + label.get<std::string>(),
                      "differs in parts or balls, or is in one map only");
  for (const auto& pair : json["voxels"]) {
    rows.emplace_back(pair["here"].get<std::string>() + ", there " + pair["there"].get<std::string>(),
                      counted(pair["count"].get<std::size_t>(), "voxel"));
  }
  const auto evidence = json["same_state_other_evidence"].get<std::size_t>();
  if (evidence > 0) rows.emplace_back("same state, other evidence", counted(evidence, "voxel"));
  out << '\n';
  print_rows(out, rows);
}

}  // namespace clearway
