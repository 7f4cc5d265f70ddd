#include <nlohmann/json.hpp>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/hand_shapes.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "apps/inspect/map_folder.hpp"
#include "datasets/sources/clock_seconds.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/painted_csv.hpp"
#include "mapping/maps/map_edit.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/query_record.hpp"

namespace clearway {

bool is_edited(const InspectOptions& options) {
  return !options.merge.empty() || !options.paint.empty() || !options.clear.empty() ||
         !options.occupy.empty() || !options.crop.empty() || options.coarsen.has_value();
}

namespace {

std::vector<PaintedVolume> painted_volumes(const std::filesystem::path& file, double resolution) {
  constexpr std::size_t largest = std::size_t{1} << 30U;
  std::vector<PaintedVolume> volumes =
      parse_painted(read_input(file, "file of painted spheres", largest), file);
  require_paintable(volumes, resolution, file);
  return volumes;
}

/// Ages count back from the newest look of all, so that they hold only where all looks are of one clock.
std::string clock_remark(const Snapshot& map, const Snapshot& other) {
  const SeenStamps *a = map.seen(), *b = other.seen();
  if (a == nullptr || b == nullptr || a->empty() || b->empty()) return {};
  const bool dated = a->newest() >= clock_begins, other_dated = b->newest() >= clock_begins;
  if (dated && other_dated) return {};
  const std::string why = dated || other_dated ? "only one of the maps has times since 1970"
                                               : "the times of both maps count from a start of their own";
  return why +
         ": the merged map does not say when voxels were last seen, as nothing says that both are of one "
         "clock, and --seen-within refuses it";
}

}  // namespace

Snapshot edited(const InspectOptions& options, const Snapshot& map, EditReport& report) {
  if (is_edited(options) && options.save.empty())
    throw std::invalid_argument(
        "--merge, --paint, --clear, --occupy, --crop and --coarsen: expected --save DIR to write the new map "
        "to");
  Snapshot result = map;
  if (!options.merge.empty()) {
    LoadedMap& other = report.merged;
    other = load_map_with(options.merge, {record_beside()}, options.cloud_resolution);
    report.clock_remark = clock_remark(map, other.map);
    result = merge(result, other.map);
    if (!report.clock_remark.empty()) result = without_times(result);
    other.map = {};
  }
  if (!options.paint.empty()) result = with_painted(result, painted_volumes(options.paint, map.resolution()));
  if (!options.clear.empty())
    result = with_cleared_voxels(result, cells_inside(options.clear, map.resolution()), report.tally);
  if (!options.occupy.empty())
    result = with_occupied_voxels(result, cells_met(options.occupy, map.resolution()), report.tally);
  if (!options.crop.empty()) {
    const std::vector<double> n = parse_numbers(options.crop, "--crop");
    if (n.size() != 6)
      throw std::invalid_argument("--crop: expected X0,Y0,Z0,X1,Y1,Z1 in metres, got '" + options.crop + "'");
    result = crop(result, {Eigen::Vector3d(n[0], n[1], n[2]), Eigen::Vector3d(n[3], n[4], n[5])});
  }
  if (options.coarsen) result = coarsen(result, *options.coarsen);
  return result;
}

std::string hand_edit_remark(const InspectOptions& options, const HandEditTally& tally) {
  const bool edits = !options.occupy.empty() || !options.clear.empty();
  if (!edits || tally.occupied + tally.conflict + tally.seen_free + tally.painted > 0) return {};
  return "--occupy and --clear change no voxel: what they name is so already, or no voxel lies wholly inside "
         "of what is cleared";
}

nlohmann::ordered_json describe_hand_edit(const HandEditTally& tally) {
  return {{"occupied", tally.occupied},
          {"conflict", tally.conflict},
          {"seen_free", tally.seen_free},
          {"painted", tally.painted}};
}

void print_hand_edit(const nlohmann::ordered_json& json, std::ostream& out) {
  const auto count = [&](const char* state) { return grouped(json[state].get<std::size_t>()); };
  print_rows(out, {{"voxels changed", count("occupied") + " to occupied, " + count("conflict") +
                                          " to conflict, " + count("seen_free") + " to seen free, " +
                                          count("painted") + " to painted"}});
}

KeptRecord record_to_keep(const InspectOptions& options, const LoadedMap& map, const LoadedMap& merged) {
  if (options.save.empty()) return {};
  KeptRecord kept{record_to_hand_on(map, options.map)};
  if (options.merge.empty()) return kept;
  if (!kept.record) return {record_to_hand_on(merged, options.merge)};
  const std::string is_not = " is kept, that of " + quote_path(options.merge.string()) + " is not";
  try {
    std::optional<QueryRecord> other = record_to_hand_on(merged, options.merge);
    if (!other) return kept;
    other->map_sha256 = kept.record->map_sha256;
    other->made_for = kept.record->made_for;
    if (to_json(*kept.record) == to_json(*other)) return kept;
  } catch (const DamagedFile&) {
    kept.remark = "the record of queries of " + quote_path(options.map.string()) + is_not + ": it is damaged";
    return kept;
  } catch (const std::invalid_argument&) {
    kept.remark =
        "the record of queries of " + quote_path(options.map.string()) + is_not + ": it cannot be read";
    return kept;
  }
  kept.remark =
      "both maps have a record of their queries: that of " + quote_path(options.map.string()) + is_not;
  return kept;
}

void save_edited(const InspectOptions& options, std::optional<QueryRecord> record, const Snapshot& map) {
  save_map_folder(options.save, map, std::move(record));
}

}  // namespace clearway
