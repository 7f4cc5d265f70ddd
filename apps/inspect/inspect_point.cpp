#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/stamps/seen_stamps.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

/// When a voxel was last seen, by the clock of the scans and before the map's newest look.
std::string last_look(const Json& json) {
  if (json["last_seen_s"].is_null()) return "at a time that the map does not know";
  return "at " + significant(json["last_seen_s"].get<double>(), 12) + " s, " +
         significant(json["age_s"].get<double>()) + " s before the newest look";
}

}  // namespace

Json describe_point(const Snapshot& map, const Provenance* provenance, const Eigen::Vector3d& point) {
  const Voxel voxel = map.voxel(point);
  Json json{{"point", to_json(point)}, {"state", to_string(voxel.state)}, {"observed", voxel.observed}};
  if (voxel.observed) {
    json["log_odds"] = voxel.log_odds;
    json["probability"] = 1.0 - 1.0 / (1.0 + std::exp(voxel.log_odds));
  }
  if (const auto seen = map.last_seen(point)) {
    json["last_seen_s"] = *seen;
    json["age_s"] = map.seen()->newest() - *seen;
  } else if (voxel.observed) {
    json["last_seen_s"] = nullptr;
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
  if (provenance != nullptr) json["provenance"] = describe_provenance(*provenance, map, point);
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

void print_point(const Json& json, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> rows{{"at", point_text(json["point"])},
                                                        {"state", json["state"].get<std::string>()}};
  if (json["observed"].get<bool>()) {
    rows.emplace_back("sensors", "probability " + significant(json["probability"].get<double>(), 3) +
                                     " (log-odds " + significant(json["log_odds"].get<double>(), 3) + ")");
  } else {
    rows.emplace_back("sensors", "never observed");
  }
  if (json.contains("last_seen_s")) rows.emplace_back("last seen", last_look(json));
  rows.emplace_back("painted by", join(json["painted_by"]));
  rows.emplace_back("inside exact balls of", join(json["inside_exact_balls"]));
  if (json.contains("provenance")) {
    for (auto& row : provenance_rows(json["provenance"])) rows.push_back(std::move(row));
  }
  for (const auto& [policy, metres] : json["clearance_m"].items()) {
    rows.emplace_back("clearance, " + policy, ">= " + length_text(metres));
  }
  out << '\n';
  print_rows(out, rows);
}

}  // namespace clearway
