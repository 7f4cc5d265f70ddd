// The distance field from nothing, its memory and its look-ups, against dynamicEDT3D on the same voxels.

#include <cmath>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/field_look_ups.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

Snapshot room_map(double resolution) {
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : room_scans(16)) map.insert(scan);
  return map.snapshot();
}

/// What the map's bounds are grown to, so that the room has at least 8 million cells at 2 cm.
Eigen::AlignedBox3d region_of(const Snapshot& map) {
  Eigen::AlignedBox3d box = map.bounds();
  if (box.isEmpty()) throw std::invalid_argument("distance field: the map is empty, expected voxels");
  while (box.volume() < 8.2e6 * std::pow(0.02, 3)) {
    box.min().array() -= 0.02;
    box.max().array() += 0.02;
  }
  return box;
}

/// Medians of both, CPU ms.
Pair measure_fields(const BothFields& fields, const BenchOptions& options) {
  const auto time = [](const auto& make) {
    decltype(make()) made;
    settle_heap();
    return 1e3 * cpu_seconds([&] { made = make(); });
  };
  return interleave(
      options, [&] { return time([&] { return fields.ours(); }); },
      [&] { return time([&] { return fields.theirs(); }); });
}

double bytes_per_cell(const BothFields& fields) {
  return static_cast<double>(fields.ours()->distances()->bytes()) / fields.region.size.cast<double>().prod();
}

/// A row of the table of fields from nothing.
Pair add_fields(const std::string& name, const BothFields& fields, const BenchOptions& options, Table& table,
                nlohmann::ordered_json& detail) {
  const Pair pair = measure_fields(fields, options);
  const double bytes = bytes_per_cell(fields);
  constexpr double peer_bytes = 28.0;  // dynamicEDT3D's cell with its pointers
  table.rows.push_back(
      {name, figure(pair.ours), figure(pair.peer), figure(pair.ratio()), figure(bytes), figure(peer_bytes)});
  detail[name] = {
      {"ours", pair.ours}, {"peer", pair.peer}, {"ratio", pair.ratio()}, {"bytes_per_cell", bytes}};
  return pair;
}

}  // namespace

BenchResult bench_field(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const Snapshot map = options.input.empty() ? room_map(resolution) : load_map(options.input, resolution);
  const Eigen::AlignedBox3d box = region_of(map);
  const BothFields fields(map, Policy::not_occupied, box, 0.5);
  const double cells = fields.region.size.cast<double>().prod();
  BenchOptions once = options;
  once.runs = 1;
  Table nothing{"From nothing, CPU ms (the last two rows: one run):",
                {"field", "ours", "dynamicEDT3D", "ratio", "bytes per cell", "dynamicEDT3D's"},
                {}};
  nlohmann::ordered_json detail{{"resolution", map.resolution()}, {"cells", cells}};
  const Pair pair = add_fields("truncated at 0.5 m", fields, options, nothing, detail);
  add_fields("truncated at 1 m", {map, Policy::not_occupied, box, 1.0}, once, nothing, detail);
  add_fields("at 0.5 m, unknown is blocked", {map, Policy::known_free, box, 0.5}, once, nothing, detail);
  options.say("look-ups");
  BenchResult result{pair.ours, pair.peer, "dynamicEDT3D", "CPU ms from nothing", true, options.runs, {}};
  const auto ours = fields.ours();
  const auto theirs = fields.theirs();
  result.tables = look_up_tables(*ours, *theirs, options.runs, detail["look_ups_per_second"]);
  result.tables.insert(result.tables.begin(), nothing);
  options.say("errors");
  result.tables.push_back(error_table(*ours, *theirs, detail["errors"]));
  result.detail = detail;
  result.compared =
      "The distance field of a room of " + figure(1e-6 * cells) + " million cells at " +
      length_text(map.resolution()) +
      " against dynamicEDT3D, same voxels. Its distances are from voxel centre to voxel centre; ours "
      "are lower bounds of the distance from the point itself, `coarse_clearance` from one cell, as "
      "dynamicEDT3D's, `clearance` from several.";
  return result;
}

}  // namespace clearway::bench
