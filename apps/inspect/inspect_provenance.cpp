#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t most_conflicts = 100;  ///< in the text; JSON has them all

Json scans_json(const Provenance& provenance, const std::vector<std::size_t>& scans) {
  Json json = Json::array();
  for (const std::size_t index : scans) {
    const ScanRecord& scan = provenance.scans.scans()[index];
    json.push_back({{"scan", scan.number}, {"sensor", scan.sensor}, {"time", scan.time}});
  }
  return json;
}

std::string stroke_name(const Provenance& provenance, int stroke) {
  return stroke < 0 ? "" : provenance.strokes[static_cast<std::size_t>(stroke)].label;
}

std::string numbers_text(const Json& scans) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < scans.size() && i < most; ++i) {
    const std::string sensor = scans[i]["sensor"].get<std::string>();
    const bool repeated = i > 0 && scans[i - 1]["sensor"] == scans[i]["sensor"];
    text += (text.empty() ? "" : ", ") + std::to_string(scans[i]["scan"].get<int>()) +
            (repeated || sensor.empty() ? "" : " (" + sensor + ")");
  }
  if (scans.size() > most) text += " ... " + grouped(scans.size()) + " in all";
  return text.empty() ? "-" : text;
}

std::string stroke_text(const Json& stroke) {
  const std::string label = stroke["stroke"].get<std::string>(), source = stroke["source"].get<std::string>();
  return "'" + stroke["volume"].get<std::string>() + "', " + (label.empty() ? "no stroke" : label) +
         (source.empty() ? "" : " (" + source + ")") + ": " +
         counted(stroke["balls"].get<std::size_t>(), "ball") + ", " +
         significant(stroke["from_s"].get<double>()) + " to " + significant(stroke["to_s"].get<double>()) +
         " s";
}

}  // namespace

Json describe_provenance(const Provenance& provenance, const Snapshot& map, const Eigen::Vector3d& point) {
  Json json{{"painted", Json::array()}, {"erased", Json::array()}};
  const auto cell = map.tree().cell(point);
  if (!cell) return json;
  for (const StrokeTouch& touch : strokes_at(provenance, *cell)) {
    const bool named = touch.stroke >= 0;
    json[touch.erases ? "erased" : "painted"].push_back(
        {{"volume", provenance.volumes[static_cast<std::size_t>(touch.volume)]},
         {"stroke", stroke_name(provenance, touch.stroke)},
         {"source", named ? provenance.strokes[static_cast<std::size_t>(touch.stroke)].source : ""},
         {"balls", touch.spheres},
         {"from_s", touch.first},
         {"to_s", touch.last}});
  }
  const ScanLog::Answer scans = provenance.scans.touched(*cell);
  json["hit_by_scans"] = scans_json(provenance, scans.hits);
  json["passed_by_scans"] = scans_json(provenance, scans.misses);
  json["scans_not_kept"] = scans_json(provenance, scans.unknown);
  json["scans_not_recorded"] = provenance.scans.not_recorded();
  json["scans_exact"] = scans.unknown.empty() && provenance.scans.not_recorded() == 0;
  return json;
}

std::vector<std::pair<std::string, std::string>> provenance_rows(const Json& json) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& stroke : json["painted"]) rows.emplace_back("painted into", stroke_text(stroke));
  for (const auto& stroke : json["erased"]) rows.emplace_back("erased from", stroke_text(stroke));
  if (!json.contains("hit_by_scans")) return rows;
  rows.emplace_back("hit by scans", numbers_text(json["hit_by_scans"]));
  rows.emplace_back("passed by scans", numbers_text(json["passed_by_scans"]));
  if (!json["scans_exact"].get<bool>()) {
    const std::size_t gone = json["scans_not_kept"].size() + json["scans_not_recorded"].get<std::size_t>();
    rows.emplace_back("perhaps touched by", grouped(gone) + " more scans, whose record went over the budget");
  }
  return rows;
}

Json describe_conflicts(const Provenance& provenance) {
  const ConflictLog& log = provenance.conflicts;
  Json json{{"appeared", log.records.size() + log.not_kept}, {"not_kept", log.not_kept}};
  std::map<int, std::string> sensors;
  for (const ScanRecord& scan : provenance.scans.scans()) sensors[scan.number] = scan.sensor;
  json["records"] = Json::array();
  for (const ConflictRecord& record : log.records) {
    const Eigen::Vector3d center = (record.cell.cast<double>().array() + 0.5) * provenance.resolution;
    Json entry{{"voxel_center", to_json(center)}, {"time", record.time}};
    entry["second"] = record.by_scan ? "scan" : "paint";
    if (record.by_scan) {
      entry["scan"] = record.index;
      if (const auto sensor = sensors.find(record.index); sensor != sensors.end())
        entry["sensor"] = sensor->second;
    } else {
      entry["volume"] = provenance.volumes[static_cast<std::size_t>(record.volume)];
      entry["stroke"] = stroke_name(provenance, record.index);
    }
    json["records"].push_back(entry);
  }
  return json;
}

void print_conflicts(const Json& json, std::ostream& out) {
  out << '\n';
  print_rows(out, {{"conflicts appeared", grouped(json["appeared"].get<std::size_t>())},
                   {"kept without record", grouped(json["not_kept"].get<std::size_t>())}});
  const Json& records = json["records"];
  if (records.empty()) return;
  std::vector<std::vector<std::string>> table{{"voxel", "time s", "second"}};
  for (std::size_t i = 0; i < records.size() && i < most_conflicts; ++i) {
    const Json& entry = records[i];
    const bool scan = entry["second"] == "scan";
    table.push_back(
        {point_text(entry["voxel_center"]),
         significant(entry["time"].get<double>(), 12) + (scan ? "" : " after the first frame"),
         scan ? "scan " + std::to_string(entry["scan"].get<int>()) + " " + entry.value("sensor", "")
              : "paint of '" + entry["volume"].get<std::string>() + "' " +
                    entry["stroke"].get<std::string>()});
  }
  print_table(out, table);
  if (records.size() > most_conflicts)
    out << "  ... " << grouped(records.size() - most_conflicts) << " more; --json lists them\n";
}

}  // namespace clearway
