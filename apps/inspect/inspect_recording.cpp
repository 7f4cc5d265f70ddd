#include "apps/inspect/inspect_recording.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "apps/console/table.hpp"
#include "apps/fusion/open_frames.hpp"
#include "datasets/bags/bag_metadata.hpp"
#include "datasets/bags/bag_source.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

/// What one sensor took of one kind.
struct Taken {
  std::size_t frames = 0, points = 0;
  double first = 0.0, last = 0.0;  ///< s since 1970

  void add(double time) {
    first = frames == 0 ? time : std::min(first, time);
    last = frames == 0 ? time : std::max(last, time);
    ++frames;
  }
};

/// "image 1280 x 720", "depth", "laser2d", "velodyne", "points", "odometry" or "comment".
std::string kind_of(const Frame& frame) {
  if (const auto* image = std::get_if<ImageFrame>(&frame.content))
    return "image " + std::to_string(image->image.width) + " x " + std::to_string(image->image.height);
  if (const auto* cloud = std::get_if<CloudFrame>(&frame.content)) return cloud->kind;
  return std::holds_alternative<OdometryFrame>(frame.content) ? "odometry" : "comment";
}

Json topics_of(const InspectOptions& options, std::vector<std::vector<std::string>>& rows) {
  Json topics = Json::array();
  rows = {{"topic", "type", "messages"}};
  for (const BagTopic& topic : list_bag(options.map)) {
    topics.push_back({{"name", topic.name}, {"type", topic.type}, {"messages", topic.count}});
    rows.push_back({plain(topic.name), plain(topic.type), std::to_string(topic.count)});
  }
  return topics;
}

Json frames_of(const InspectOptions& options, std::vector<std::vector<std::string>>& rows) {
  Json frames = Json::array();
  rows = {{"frame", "parent", "moves"}};
  for (const BagFrame& frame : list_frames(options.map)) {
    frames.push_back({{"name", frame.name}, {"parent", frame.parent}, {"moves", !frame.is_fixed}});
    rows.push_back({plain(frame.name), plain(frame.parent), frame.is_fixed ? "no" : "yes"});
  }
  return frames;
}

Json sensors_of(FrameSource& frames, std::vector<std::vector<std::string>>& rows) {
  std::map<std::pair<std::string, std::string>, Taken> sensors;  // by label and kind
  double begin = HUGE_VAL;
  while (const std::optional<Frame> frame = frames.next()) {
    Taken& taken = sensors[{frame->sensor, kind_of(*frame)}];
    taken.add(frame->time);
    begin = std::min(begin, frame->time);
    if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) taken.points += cloud->points.size();
  }
  Json json = Json::array();
  rows = {{"sensor", "kind", "frames", "points", "from s", "to s"}};
  for (const auto& [name, taken] : sensors) {
    json.push_back({{"sensor", name.first},
                    {"kind", name.second},
                    {"frames", taken.frames},
                    {"points", taken.points},
                    {"first_s", taken.first},
                    {"last_s", taken.last}});
    rows.push_back({name.first.empty() ? "-" : plain(name.first), name.second, std::to_string(taken.frames),
                    taken.points > 0 ? std::to_string(taken.points) : "-", short_text(taken.first - begin, 6),
                    short_text(taken.last - begin, 6)});
  }
  return json;
}

}  // namespace

int inspect_recording(const InspectOptions& options, Console& console) {
  const std::string name = options.map.string();
  if (!options.at.empty() || !options.rays.empty() || !options.slices.empty() || !options.exports.empty() ||
      !options.view.empty() || !options.save.empty() || !options.diff.empty() || options.conflicts ||
      options.holes)
    throw std::invalid_argument(quote_path(name) +
                                " is a recording, not a map: expected no other flag than --json beside it");
  std::vector<std::vector<std::string>> rows, frame_rows;
  Json json;
  std::optional<std::string> damage;
  if (is_bag(options.map)) {
    json["bag"] = name;
    json["topics"] = topics_of(options, rows);
    json["frames"] = frames_of(options, frame_rows);
    damage = bag_damage(options.map);
    if (!damage && is_bag_folder(options.map)) damage = missing_parts(options.map, listed_parts(options.map));
  } else {
    const std::unique_ptr<FrameSource> frames = open_frames(options.map, {});
    json["recording"] = name;
    json["sensors"] = sensors_of(*frames, rows);
    for (const std::string& warning : frames->warnings()) console.warn(warning);
    damage = frames->damage();
  }
  if (damage) json["damage"] = *damage;
  if (console.json) {
    console.out() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  } else {
    print_table(console.out(), rows);
    if (frame_rows.size() > 1) print_table(console.out() << '\n', frame_rows);
  }
  if (damage) console.warn(*damage);
  return damage ? exit_damaged : exit_done;
}

}  // namespace clearway
