#include "planning/gate/voxel_evidence.hpp"

#include <algorithm>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

void add_history(const Provenance& history, const Eigen::Vector3i& cell, VoxelEvidence& evidence) {
  evidence.has_history = true;
  const ScanLog::Answer scans = history.scans.touched(cell);
  evidence.hit_count = scans.hits.size();
  evidence.pass_count = scans.misses.size();
  evidence.forgotten = scans.unknown.size() + history.scans.not_recorded();
  const std::size_t named = std::min(scans.hits.size(), VoxelEvidence::most_named);
  for (auto hit = scans.hits.rbegin(); hit != scans.hits.rbegin() + static_cast<std::ptrdiff_t>(named);
       ++hit) {
    const ScanRecord& scan = history.scans.scans()[*hit];
    evidence.hits.push_back({scan.number, scan.sensor, scan.time});
  }
  for (const StrokeTouch& touch : strokes_at(history, cell)) {
    StrokeName name;
    name.volume = history.volumes[static_cast<std::size_t>(touch.volume)];
    name.erases = touch.erases;
    name.first = touch.first;
    name.last = touch.last;
    if (touch.stroke >= 0) {
      name.stroke = history.strokes[static_cast<std::size_t>(touch.stroke)].label;
      name.source = history.strokes[static_cast<std::size_t>(touch.stroke)].source;
    }
    evidence.strokes.push_back(std::move(name));
  }
}

std::string hits_text(const VoxelEvidence& evidence) {
  std::string text = evidence.hit_count == 1
                         ? std::string("hit by ")
                         : "hit by " + std::to_string(evidence.hit_count) + " scans, last by ";
  const ScanName& last = evidence.hits.front();
  text += "scan " + std::to_string(last.number);
  if (!last.sensor.empty()) text += " of " + quote(last.sensor);
  return text + " at " + short_text(last.time, 12) + " s";
}

std::string sensors_text(const VoxelEvidence& evidence) {
  if (!evidence.voxel.observed) return "no scan saw it";
  std::string text;
  if (!evidence.hits.empty())
    text = hits_text(evidence);
  else if (evidence.has_history && evidence.forgotten == 0 && evidence.pass_count > 0)
    text = "passed by " + counted(evidence.pass_count, "scan") + ", hit by none";
  else
    text = "seen by scans that are not on record";
  if (evidence.last_seen) text += ", last seen at " + short_text(*evidence.last_seen, 12) + " s";
  return text;
}

std::string stroke_text(const StrokeName& stroke) {
  std::string text = stroke.erases ? "erased from " : "painted into ";
  text += quote(stroke.volume);
  if (!stroke.stroke.empty()) text += " by " + quote(stroke.stroke);
  if (!stroke.source.empty()) text += " of " + quote(stroke.source);
  return text + " at " + short_text(stroke.last, 12) + " s";
}

std::string paint_text(const VoxelEvidence& evidence) {
  std::string text;
  for (const StrokeName& stroke : evidence.strokes) text += (text.empty() ? "" : ", ") + stroke_text(stroke);
  if (!text.empty()) return text;
  for (const std::string& label : evidence.painted_by) text += (text.empty() ? "" : ", ") + quote(label);
  return text.empty() ? "painted by no one" : "painted into " + text;
}

}  // namespace

std::string VoxelEvidence::sentence() const { return sensors_text(*this) + "; " + paint_text(*this); }

VoxelEvidence evidence_of(const Snapshot& map, const Provenance* history,
                          const Eigen::Vector3d& cell_center) {
  VoxelEvidence evidence;
  evidence.voxel = map.voxel(cell_center);
  evidence.last_seen = map.last_seen(cell_center);
  for (std::size_t i = 0; i < map.volumes().size(); ++i) {
    if ((evidence.voxel.volumes >> i & 1U) != 0) evidence.painted_by.push_back(map.volumes()[i].label);
  }
  if (history != nullptr)
    add_history(*history, (cell_center / map.resolution()).array().floor().cast<int>(), evidence);
  return evidence;
}

}  // namespace clearway
