#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "apps/inspect/inspect_recording.hpp"
#include "apps/inspect/map_folder.hpp"
#include "apps/inspect/slice_image.hpp"
#include "apps/pages/map_page.hpp"
#include "datasets/bags/bag_source.hpp"
#include "datasets/bags/unread_recordings.hpp"
#include "datasets/sources/scan_graph.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

std::vector<Eigen::Vector3d> points_of(const std::vector<std::string>& texts) {
  std::vector<Eigen::Vector3d> points;
  for (const std::string& text : texts) {
    const auto numbers = parse_numbers(text, "--at");
    if (numbers.size() != 3)
      throw std::invalid_argument("--at: expected X,Y,Z in metres, got '" + text + "'");
    points.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  return points;
}

/// Whether places in the map are asked for, or another map: else one pass over its file answers all.
bool needs_memory(const InspectOptions& options) {
  return is_edited(options) || !options.at.empty() || !options.rays.empty() || options.holes ||
         !options.clearance.empty() || !options.exports.empty() || !options.diff.empty() ||
         !options.save.empty();
}

void require_in_reach(const std::vector<Eigen::Vector3d>& points, const Snapshot& map) {
  const double farthest = 32768.0 * map.resolution();  // where OctoMap's keys end
  for (const Eigen::Vector3d& point : points) {
    if (point.cwiseAbs().maxCoeff() <= farthest) continue;
    throw std::invalid_argument("--at: " + significant(point.cwiseAbs().maxCoeff()) +
                                " m is beyond what a map of this resolution can hold, " +
                                significant(farthest) + " m");
  }
}

/// Refuses, before the work, what cannot be written or is read.
void require_outputs(const InspectOptions& options) {
  std::vector<NamedPlace> files = {{"--view", options.view}};
  for (const auto& [plane, file] : options.slices) files.push_back({"--slice", file});
  for (const auto& file : options.exports) files.push_back({"--export", file});
  std::vector<NamedPlace> outputs = files;
  outputs.push_back({"--save", options.save});
  require_apart(outputs, {{"MAP", options.map},
                          {"--diff", options.diff},
                          {"--merge", options.merge},
                          {"--paint", options.paint}});
  for (const NamedPlace& file : files)
    if (!file.path.empty()) require_writable(file.path);
  if (options.save.empty()) return;
  require_saved_map_place("--save", options.save);
}

/// What replay wrote beside the map; none for a map that was edited since, with a word about it.
std::optional<Provenance> provenance_of(const InspectOptions& options, const std::string& sha256,
                                        Console& console) {
  if (!options.save.empty() || (options.at.empty() && !options.conflicts)) return std::nullopt;
  std::optional<Provenance> found = load_provenance(options.map);
  if (!found && options.conflicts)
    throw std::invalid_argument("--conflicts: " + options.map.string() +
                                " holds no provenance.bin, expected a folder written by replay");
  if (found && found->map_sha256 != sha256) {
    console.warn("warning: provenance.bin belongs to another map and is not used");
    return std::nullopt;
  }
  return found;
}

/// As wide as the terminal; colours where it is one; axes above, a legend below.
std::string draw_in_terminal(const MapLeaves& map, const SlicePlane& plane, bool shows_difference) {
  winsize size{};
  const bool is_terminal = ::isatty(STDOUT_FILENO) != 0;
  const bool known = is_terminal && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  const bool colours = is_terminal && std::getenv("NO_COLOR") == nullptr;
  return slice_caption(map, plane) +
         slice_text(map, plane, known ? size.ws_col : 100, colours, shows_difference) +
         slice_legend(colours, shows_difference);
}

void print_text(const InspectOptions& options, const Json& json, Console& console) {
  print_map(json, console.out());
  if (json.contains("at"))
    for (const auto& point : json["at"]) print_point(point, console.out());
  if (json.contains("rays"))
    for (const auto& ray : json["rays"]) print_ray(ray, console.out());
  if (json.contains("conflicts")) print_conflicts(json["conflicts"], console.out());
  if (json.contains("diff")) print_difference(json["diff"], console.out());
  if (options.holes) print_volumes(json["painted_volumes"], console.out());
  for (const auto& slice : options.slices) console.out() << "  picture: " << slice.second << '\n';
  for (const auto& file : options.exports) console.out() << "  exported: " << file.string() << '\n';
  if (!options.view.empty()) console.out() << "  page: " << options.view.string() << '\n';
  if (json.contains("edited")) print_hand_edit(json["edited"], console.out());
  if (!options.save.empty()) console.out() << "  saved: " << options.save.string() << '\n';
}

/// Names of what `inspect` lists, or refuses with the way out; other files are maps.
bool is_recording_name(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  if (kind == ".gz") return extension_of(file.stem()) == ".rawlog";
  constexpr std::array<std::string_view, 7> recordings{".rawlog", ".sens", ".mp4", ".mov",
                                                       ".mkv",    ".webm", ".avi"};
  const bool is_packed = !std::filesystem::is_directory(file) && !unread_recording(file).empty();
  return is_bag(file) || is_packed ||
         std::find(recordings.begin(), recordings.end(), kind) != recordings.end();
}

/// What may be a folder of pictures or clouds.
bool is_folder_without_map(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_directory(folder, error) && !std::filesystem::exists(folder / "map.ot", error);
}

/// What the flags ask for, but for the places that they name by themselves.
struct Questions {
  std::vector<std::pair<SlicePlane, std::filesystem::path>> slices;
  std::vector<SlicePlane> terms;
  std::optional<Policy> clearance;  ///< of the lines in the slices
  std::vector<Eigen::Vector3d> points;
};

/// No difference is too far away to be shown, and a box that was asked for is not cut.
bool is_shown_whole(const InspectOptions& options) {
  return options.whole || !options.diff.empty() || !options.crop.empty();
}

/// @throws std::invalid_argument for flags that are none, or do not go together
Questions read_questions(const InspectOptions& options, bool is_json) {
  Questions asked;
  for (const auto& [plane, file] : options.slices) asked.slices.emplace_back(parse_slice(plane), file);
  if (!options.clearance.empty()) asked.clearance = parse_policy(options.clearance);
  for (const std::string& plane : options.terms) asked.terms.push_back(parse_plane(plane, "--term"));
  if (!asked.terms.empty() && is_json)
    throw std::invalid_argument("--term: expected no --json beside it, which prints nothing but JSON");
  if (!options.diff.empty() && (asked.clearance || options.age))
    throw std::invalid_argument("--diff: expected neither --clearance nor --age beside it");
  if (asked.clearance && asked.slices.empty())
    throw std::invalid_argument("--clearance: expected --slice beside it, in which to draw the lines");
  if (options.age && asked.slices.empty())
    throw std::invalid_argument("--age: expected --slice beside it, which it colours");
  if (options.whole && asked.slices.empty() && asked.terms.empty() && options.view.empty())
    throw std::invalid_argument("--whole: expected --slice, --term or --view beside it, which it widens");
  const bool is_whole = is_shown_whole(options);
  for (auto& [plane, file] : asked.slices) plane.is_whole = is_whole;
  for (SlicePlane& plane : asked.terms) plane.is_whole = is_whole;
  asked.points = points_of(options.at);
  return asked;
}

/// The map that is asked and the one that it is compared with. All is read before anything is said; see
/// hand_over.cpp.
struct InspectedMaps {
  explicit InspectedMaps(const InspectOptions& options);

  std::optional<LoadedMap> loaded;  ///< as it was, where places in it are asked for
  EditReport edits;
  MapLeaves leaves;  ///< as it is now
  KeptRecord kept;
  std::optional<Snapshot> other;

  const Snapshot& map() const { return leaves.about(); }
  const std::string& sha256() const { return loaded ? loaded->sha256 : leaves.sha256(); }
};

/// Its record of queries is for the map that --save makes of it.
LoadedMap load_with_record(const InspectOptions& options) {
  std::vector<FileBeside> beside;
  if (!options.save.empty()) beside.push_back(record_beside());
  return load_map_with(options.map, beside, options.cloud_resolution);
}

InspectedMaps::InspectedMaps(const InspectOptions& options)
    : loaded(needs_memory(options) ? std::optional(load_with_record(options)) : std::nullopt),
      leaves(loaded ? MapLeaves(edited(options, loaded->map, edits))
                    : MapLeaves::in_file(options.map, options.cloud_resolution)),
      kept(loaded ? record_to_keep(options, *loaded, edits.merged) : KeptRecord()) {
  if (!options.diff.empty()) other = load_map(options.diff, options.cloud_resolution);
}

/// What file and flags leave in doubt.
void report_maps(const InspectOptions& options, const InspectedMaps& maps, Console& console) {
  const MapLeaves& leaves = maps.leaves;
  const Snapshot& as_read = maps.loaded ? maps.loaded->map : maps.map();
  console.note(maps.kept.remark);
  console.note(painted_csv_remark(options.map, as_read));
  console.note(cloud_remark(options.map, as_read, options.cloud_resolution.has_value()));
  if (!options.crop.empty() && leaves.bounds().isEmpty())
    console.note("the map holds nothing inside of --crop");
  if (!options.paint.empty() && leaves.counts().painted + leaves.counts().conflict == 0)
    console.note("no ball of --paint holds a whole voxel of " + significant(1000.0 * leaves.resolution(), 3) +
                 " mm" + (options.crop.empty() ? "" : " inside of --crop") + ", so that nothing is painted");
  console.note(maps.edits.clock_remark);
  console.note(hand_edit_remark(options, maps.edits.tally));
}

Json answers(const InspectOptions& options, const Questions& asked, const InspectedMaps& maps,
             const Provenance* provenance) {
  const Snapshot& map = maps.map();
  Json json = describe_map(options, maps.leaves, maps.sha256());
  if (!options.occupy.empty() || !options.clear.empty())
    json["edited"] = describe_hand_edit(maps.edits.tally);
  for (const Eigen::Vector3d& point : asked.points)
    json["at"].push_back(describe_point(map, provenance, point));
  for (const std::string& ray : options.rays) json["rays"].push_back(describe_ray(map, ray));
  if (options.conflicts && provenance != nullptr) json["conflicts"] = describe_conflicts(*provenance);
  if (maps.other) json["diff"] = describe_difference(map, *maps.other, options.diff);
  if (options.holes) json["painted_volumes"] = describe_volumes(map);
  return json;
}

/// Draws and writes the map, or its difference to the other one. Returns the pictures for the terminal.
std::string draw(const InspectOptions& options, const Questions& asked, const InspectedMaps& maps,
                 Console& console) {
  const bool is_difference = maps.other.has_value();
  const bool draws = !asked.slices.empty() || !asked.terms.empty() || !options.view.empty();
  const MapLeaves drawn =
      is_difference && draws ? MapLeaves::difference(maps.map(), *maps.other) : maps.leaves;
  const std::string name = is_difference
                               ? "from " + name_of_map(options.map) + " to " + name_of_map(options.diff)
                               : name_of_map(options.map);
  for (const auto& [plane, file] : asked.slices) {
    const std::string beyond =
        write_slice_image(drawn, plane, file, {name, asked.clearance, is_difference, options.age});
    if (!beyond.empty()) console.note(file.string() + ": " + beyond);
  }
  std::string text;
  for (const SlicePlane& plane : asked.terms) text += '\n' + draw_in_terminal(drawn, plane, is_difference);
  for (const auto& file : options.exports) {
    export_map(maps.map(), file);
    if (const std::string unsaid = unsaid_in_export(maps.map(), file); !unsaid.empty())
      console.note(quote_path(file.string()) + " does not say what the map does: " + unsaid);
  }
  const auto place = is_edited(options) ? std::nullopt : std::optional(options.map.string());
  if (!options.view.empty())
    save_file(options.view, is_difference ? difference_page(drawn, name)
                                          : map_page(maps.leaves, name, place, is_shown_whole(options)));
  return text;
}

}  // namespace

int run_inspect(const InspectOptions& options, Console& console) {
  if (is_recording_name(options.map) || is_folder_without_map(options.map) || is_scan_graph(options.map))
    return inspect_recording(options, console);
  const Questions asked = read_questions(options, console.json);
  require_outputs(options);
  const InspectedMaps maps(options);
  report_maps(options, maps, console);
  require_in_reach(asked.points, maps.map());
  const std::optional<Provenance> provenance = provenance_of(options, maps.sha256(), console);

  Json json = answers(options, asked, maps, provenance ? &*provenance : nullptr);
  const std::string text = draw(options, asked, maps, console);
  if (!options.save.empty()) {
    save_edited(options, maps.kept.record, maps.map());
    json["saved"] = options.save.string();
  }
  if (console.json) {
    console.out() << json.dump(2) << '\n';
  } else {
    print_text(options, json, console);
    console.out() << text;
  }
  return json.contains("diff") && json["diff"]["differ"].get<bool>() ? exit_no : exit_done;
}

}  // namespace clearway
