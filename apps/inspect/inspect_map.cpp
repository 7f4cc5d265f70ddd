#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

std::string point_text(const Json& point) {
  std::string text;
  for (const auto& value : point) text += (text.empty() ? "" : ", ") + significant(value.get<double>(), 6);
  return text;
}

std::string join(const Json& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text.empty() ? "-" : text;
}

std::string length_text(const Json& metres) {
  const double length = metres.get<double>();
  return std::abs(length) < 10.0 ? significant(length * 1000.0, 4) + " mm" : significant(length, 5) + " m";
}

std::string name_of_map(const std::filesystem::path& map) {
  const std::filesystem::path normal = std::filesystem::absolute(map).lexically_normal();
  const bool is_named = normal.has_filename() && normal.filename() != "map.ot";
  const std::string name = (is_named ? normal : normal.parent_path()).filename().string();
  return name.empty() ? "map" : name;
}

Json describe_map(const InspectOptions& options, const MapLeaves& leaves, const std::string& sha256) {
  const Snapshot& map = leaves.about();
  const VoxelCounts counts = leaves.counts();
  const double voxel_volume = std::pow(map.resolution(), 3);
  Json json;
  json["map"] = options.map.string();
  json["sha256"] = sha256;
  json["resolution"] = map.resolution();
  json["integration"] = to_string(integration_of(map));
  json["voxels"] = {{"painted", counts.painted},
                    {"seen_free", counts.seen_free},
                    {"occupied", counts.occupied},
                    {"conflict", counts.conflict}};
  if (const ScanAgreement& agreement = map.tree().agreement();
      agreement.looked_up > 0 || agreement.compared > 0) {
    json["hits_called_free"] = {{"share", agreement.share_called_free()},
                                {"called_free", agreement.called_free},
                                {"looked_up", agreement.looked_up},
                                {"amid_free", agreement.amid_free},
                                {"compared", agreement.compared}};
  }
  if (const std::string caveat = contradiction_caveat(map); !caveat.empty()) json["contradictions"] = caveat;
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) json["damaged_recording"] = caveat;
  if (const HandEdits& edits = map.tree().hand_edits(); edits.occupied > 0 || edits.freed > 0)
    json["voxels_by_hand"] = {{"occupied", edits.occupied}, {"freed", edits.freed}};
  if (const std::uint64_t cut = map.tree().hand_edits().cut; cut > 0) json["voxels_cut"] = cut;
  if (const Eigen::AlignedBox3d bounds = leaves.bounds(); !bounds.isEmpty()) {
    json["bounds"] = {{"min", to_json(bounds.min())}, {"max", to_json(bounds.max())}};
  }
  json["painted_volume_m3"] = static_cast<double>(counts.painted) * voxel_volume;
  json["volumes"] = Json::array();
  for (const PaintedVolume& volume : map.volumes()) {
    json["volumes"].push_back({{"label", volume.label},
                               {"critical_parts", volume.critical_parts},
                               {"balls", volume.spheres.size()}});
  }
  if (const SeenStamps* seen = map.seen()) {
    json["seen"] = {{"newest_s", seen->newest()},   {"oldest_s", seen->oldest()},
                    {"known_to_s", seen->period()}, {"voxels", seen->voxels()},
                    {"bytes", seen->bytes()},       {"tree_bytes", leaves.tree_bytes()}};
  }
  return json;
}

namespace {

std::string integration_text(const Json& json) {
  const auto name = json["integration"].get<std::string>();
  if (name == "none") return "none: no scan is in the map";
  if (name == "unknown") return "unknown: a foreign or older file";
  return name;
}

/// From which time on voxels were last seen, and what it costs to know.
std::string look_times(const Json& seen) {
  const auto number = [&](const char* key) { return seen[key].get<double>(); };
  return significant(number("oldest_s"), 12) + " to " + significant(number("newest_s"), 12) +
         " s (ages 0 to " + significant(number("newest_s") - number("oldest_s")) + " s, known to " +
         significant(number("known_to_s")) + " s; " + significant(number("bytes") / 1e6, 3) + " MB, " +
         significant(number("bytes") / std::max(1.0, number("voxels")), 3) +
         " bytes a voxel, beside a tree of " + significant(number("tree_bytes") / 1e6, 3) + " MB)";
}

}  // namespace

void print_map(const Json& json, std::ostream& out) {
  std::vector<std::pair<std::string, std::string>> rows{{"map", json["map"].get<std::string>()},
                                                        {"resolution", length_text(json["resolution"])},
                                                        {"integration", integration_text(json)}};
  if (json.contains("bounds")) {
    const Json& box = json["bounds"];
    const char* names[] = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows.emplace_back(names[axis], place_text(box["min"][axis].get<double>()) + " to " +
                                         place_text(box["max"][axis].get<double>()) + " m");
    }
  }
  if (json.contains("hits_called_free")) {
    const Json& hits = json["hits_called_free"];
    rows.emplace_back("hits called free", significant(100.0 * hits["share"].get<double>(), 2) + " % of " +
                                              grouped(hits["looked_up"].get<std::size_t>()) +
                                              " looked up before their scan was integrated");
  }
  if (json.contains("contradictions"))
    rows.emplace_back("warning", json["contradictions"].get<std::string>());
  if (json.contains("damaged_recording"))
    rows.emplace_back("warning", json["damaged_recording"].get<std::string>());
  if (json.contains("voxels_cut"))
    rows.emplace_back("cropped",
                      grouped(json["voxels_cut"].get<std::size_t>()) + " occupied voxels were cut off");
  if (json.contains("voxels_by_hand")) {
    const auto count = [&](const char* what) {
      return grouped(json["voxels_by_hand"][what].get<std::size_t>());
    };
    rows.emplace_back("edited by hand",
                      count("occupied") + " voxels made occupied, " + count("freed") + " made free");
  }
  for (const auto& [state, count] : json["voxels"].items())
    rows.emplace_back(state, grouped(count.get<std::size_t>()));
  rows.emplace_back("last seen", json.contains("seen") ? look_times(json["seen"]) : "not known when");
  for (const auto& volume : json["volumes"]) {
    rows.emplace_back(
        "volume " + volume["label"].get<std::string>(),
        counted(volume["balls"].get<std::size_t>(), "ball") + ", parts: " + join(volume["critical_parts"]));
  }
  print_rows(out, rows);
}

}  // namespace clearway
