#include "apps/pages/page_timeline.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "apps/pages/voxel_faces.hpp"

namespace clearway {
namespace {

using nlohmann::json;

json placed(const ArrayPlace& at) { return {{"type", at.type}, {"offset", at.offset}, {"count", at.count}}; }

json floats(PageArrays& arrays, const std::vector<float>& values) {
  return placed(arrays.add(std::span<const float>(values)));
}

json bytes(PageArrays& arrays, const std::vector<std::uint8_t>& values) {
  return placed(arrays.add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size())));
}

/// x, y, z, radius, volume (below zero: -1 - volume, erased) and time of each.
json balls_json(PageArrays& arrays, const std::vector<PaintEvent>& events) {
  std::vector<float> values;
  const std::size_t shown = std::min(events.size(), most_timeline_balls);
  for (std::size_t i = 0; i < shown; ++i) {
    const PaintEvent& event = events[i * events.size() / shown];
    for (const double value :
         {event.sphere.center.x(), event.sphere.center.y(), event.sphere.center.z(), event.sphere.radius,
          event.erases ? -1.0 - event.volume : 1.0 * event.volume, event.time})
      values.push_back(static_cast<float>(value));
  }
  return floats(arrays, values);
}

/// Voxels that became painted and occupied at some time, and what came second: 2 n + 3 for scan n, 2 n + 2
/// for stroke n, 0 for paint outside any stroke.
json conflicts_json(PageArrays& arrays, const Provenance& provenance, double start) {
  std::vector<float> times;
  std::vector<std::uint16_t> cells;
  std::vector<std::uint32_t> seconds;
  for (const ConflictRecord& record : provenance.conflicts.records) {
    times.push_back(static_cast<float>(record.by_scan ? record.time - start : record.time));
    for (int a = 0; a < 3; ++a) cells.push_back(static_cast<std::uint16_t>(record.cell[a] + kOriginVoxel));
    seconds.push_back(static_cast<std::uint32_t>(2 * (record.index + 1) + (record.by_scan ? 1 : 0)));
  }
  json strokes = json::array();
  for (const Stroke& stroke : provenance.strokes) strokes.push_back(stroke.label);
  return {{"times", floats(arrays, times)},
          {"cells", placed(arrays.add(std::span<const std::uint16_t>(cells)))},
          {"seconds", placed(arrays.add(std::span<const std::uint32_t>(seconds)))},
          {"strokes", strokes},
          {"notKept", provenance.conflicts.not_kept}};
}

}  // namespace

json timeline_json(PageArrays& arrays, const RecordingTimeline& recording, const Provenance& provenance) {
  if (recording.images.empty() && recording.scans.empty() && provenance.events.empty()) return nullptr;
  double last = 0.0;
  for (const std::vector<double>* times : {&recording.images, &recording.scans})
    if (!times->empty()) last = std::max(last, times->back());
  for (const PaintEvent& event : provenance.events) last = std::max(last, event.time);
  json refusals = json::array(), pictures = json::array();
  for (const TimelineRefusal& run : recording.refusals)
    refusals.push_back({{"from", run.from},
                        {"to", run.to},
                        {"images", run.images},
                        {"refusal", run.refusal},
                        {"reason", run.reason}});
  for (const TimelinePicture& picture : recording.pictures)
    pictures.push_back(
        {{"time", picture.time}, {"jpeg", placed(arrays.add(std::string_view(picture.jpeg)))}});
  const std::vector<float> images(recording.images.begin(), recording.images.end());
  const std::vector<float> scans(recording.scans.begin(), recording.scans.end());
  return {{"duration", last},
          {"images", floats(arrays, images)},
          {"tags", bytes(arrays, recording.tags)},
          {"accepted", bytes(arrays, recording.accepted)},
          {"scans", floats(arrays, scans)},
          {"refusals", refusals},
          {"refusalsLeftOut", recording.refusals_left_out},
          {"pictures", pictures},
          {"balls", balls_json(arrays, provenance.events)},
          {"ballCount", provenance.events.size()},
          {"conflicts", conflicts_json(arrays, provenance, recording.start)}};
}

}  // namespace clearway
