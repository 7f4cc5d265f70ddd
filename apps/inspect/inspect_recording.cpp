#include "apps/inspect/inspect_recording.hpp"

#include <algorithm>
#include <array>
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
#include "datasets/pictures/depth_layout.hpp"
#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_file.hpp"
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

/// The topics whose clocks are farthest apart, by their first messages; empty: none are by more than a
/// second.
std::string clocks_remark(const BagListing& bag) {
  std::optional<std::pair<double, std::string>> least, most;
  for (const auto& [name, content] : bag.contents) {
    if (!content.clock_offset) continue;
    const std::pair<double, std::string> offset{*content.clock_offset, name};
    if (!least || offset.first < least->first) least = offset;
    if (!most || offset.first > most->first) most = offset;
  }
  if (!least || most->first - least->first <= 1.0) return "";
  return "the first stamps of topics " + quote(least->second) + " and " + quote(most->second) +
         " are of clocks that differ by " + short_text(most->first - least->first, 5) +
         " s, by the times of recording";
}

Json topics_of(const BagListing& bag, std::vector<std::vector<std::string>>& rows) {
  Json topics = Json::array();
  rows = {{"topic", "type", "messages", "frame", "encoding", "from s", "to s"}};
  const bool are_clocks_shown = !clocks_remark(bag).empty();
  if (are_clocks_shown) rows.front().push_back("stamp - recording s");
  double begin = HUGE_VAL;
  for (const auto& [name, content] : bag.contents) begin = std::min(begin, content.recorded.first);
  const auto shown = [](const std::string& text) { return text.empty() ? "-" : plain(text); };
  for (const BagTopic& topic : bag.topics) {
    Json json{{"name", topic.name}, {"type", topic.type}, {"messages", topic.count}};
    std::vector<std::string> row{plain(topic.name), plain(topic.type), std::to_string(topic.count)};
    if (const auto found = bag.contents.find(topic.name); found != bag.contents.end()) {
      const auto& [frame, encoding, recorded, offset] = found->second;
      if (!frame.empty()) json["frame"] = frame;
      if (!encoding.empty()) json["encoding"] = encoding;
      json["first_s"] = recorded.first;
      json["last_s"] = recorded.last;
      if (offset) json["clock_offset_s"] = *offset;
      row.insert(row.end(), {shown(frame), shown(encoding), short_text(recorded.first - begin, 6),
                             short_text(recorded.last - begin, 6)});
      if (are_clocks_shown && offset) row.push_back(short_text(*offset, 6));
    }
    row.resize(rows.front().size(), "-");
    topics.push_back(std::move(json));
    rows.push_back(std::move(row));
  }
  return topics;
}

Json frames_of(const BagListing& bag, std::vector<std::vector<std::string>>& rows) {
  Json frames = Json::array();
  rows = {{"frame", "parent", "moves"}};
  for (const BagFrame& frame : bag.frames) {
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

/// The pictures of a folder, whatever their camera: their number, size and times; what they show is not read.
Json pictures_of(const DepthLayout& layout, std::vector<std::vector<std::string>>& rows, Console& console) {
  Json json = Json::array();
  rows = {{"sensor", "kind", "frames", "from s", "to s"}};
  std::string caveat;  // that was told
  const auto add = [&](const char* name, const std::vector<std::filesystem::path>& pictures,
                       const std::optional<ImageSize>& size) {
    if (pictures.empty()) return;
    const TimedFiles timed = times_of_files(pictures, std::nullopt);
    const std::string kind =
        name + (size ? " " + std::to_string(size->width) + " x " + std::to_string(size->height) : "");
    const double first = timed.files.front().time, last = timed.files.back().time;
    json.push_back({{"sensor", name},
                    {"kind", kind},
                    {"frames", timed.files.size()},
                    {"first_s", first},
                    {"last_s", last}});
    rows.push_back({name, kind, std::to_string(timed.files.size()), "0", short_text(last - first, 6)});
    for (const std::string& warning : timed.warnings) console.warn(warning);
    if (timed.time_caveat != caveat && !timed.time_caveat.empty()) console.warn(timed.time_caveat);
    caveat = timed.time_caveat;
  };
  const auto head = depth_picture_head(in_order_of_names(layout.depth));
  add("depth", layout.depth, head ? std::optional(head->size) : std::nullopt);
  add("colour", layout.colour, layout.colour.empty() ? std::nullopt : picture_size(layout.colour.front()));
  return json;
}

/// The depth pictures of a folder; nothing where there are none.
std::optional<DepthLayout> depth_in(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return std::nullopt;
  try {
    return depth_layout(folder);
  } catch (const std::filesystem::filesystem_error&) {  // told by who reads it
    return std::nullopt;
  }
}

/// Whether a folder that is no bag holds frames, or folders in which data sets keep them.
bool holds_frames(const std::filesystem::path& folder) {
  if (depth_in(folder)) return true;
  constexpr std::array inner{"mav0", "cam0", "rgb", "data", "velodyne_points"};
  std::error_code error;
  const auto entries = std::filesystem::directory_iterator(folder, error);
  return std::any_of(begin(entries), end(entries), [&](const auto& entry) {
    return is_picture_file(entry.path()) || is_cloud_file(entry.path()) ||
           std::find(inner.begin(), inner.end(), entry.path().filename()) != inner.end();
  });
}

}  // namespace

int inspect_recording(const InspectOptions& options, Console& console) {
  const std::string name = options.map.string();
  std::error_code error;
  if (std::filesystem::is_directory(options.map, error) && !is_bag(options.map) && !holds_frames(options.map))
    static_cast<void>(load_map(options.map));  // which says what it lacks
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
    const BagListing bag = list_contents(options.map);
    json["topics"] = topics_of(bag, rows);
    json["frames"] = frames_of(bag, frame_rows);
    if (const std::string remark = clocks_remark(bag); !remark.empty()) console.warn(remark);
    damage = bag.damage;
    if (!damage && is_bag_folder(options.map)) damage = missing_parts(options.map, listed_parts(options.map));
  } else if (const auto layout = depth_in(options.map)) {
    json["recording"] = name;
    json["sensors"] = pictures_of(*layout, rows, console);
    const std::filesystem::path& poses = layout->poses.empty() ? layout->pose_folder : layout->poses;
    if (!poses.empty()) json["poses"] = poses.string();
    console.warn(poses.empty() ? "no poses of the depth pictures lie beside them"
                               : "poses are in " + quote_path(poses.string()));
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
