#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "mapping/volumes/volume_quality.hpp"

namespace clearway {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t most_rows = 12;  ///< of holes, necks and gaps in the text; JSON has them all

Json describe_exact(const VolumeQuality& quality) {
  if (quality.spheres == 0) return nullptr;
  return {{"volume_m3", quality.exact.middle()},
          {"volume_error_m3", quality.exact.half_width()},
          {"not_covered_m3", quality.loss()},
          {"not_covered_share", quality.loss() / quality.exact.middle()},
          {"surface_m2", quality.surface.area},
          {"surface_error_m2", quality.surface.error},
          {"surface_per_volume_1_m", quality.surface.area / quality.exact.middle()},
          {"sphericity", quality.sphericity()}};
}

Json describe_spacing(const SampleSpacing& spacing) {
  Json json{{"median_m", spacing.median},
            {"largest_m", spacing.largest},
            {"median_over_radius", spacing.median_relative},
            {"largest_over_radius", spacing.largest_relative},
            {"thin", Json::array()}};
  for (const ThinOverlap& thin : spacing.thin) {
    json["thin"].push_back({{"ball", thin.sphere},
                            {"position", to_json(thin.position)},
                            {"distance_m", thin.distance},
                            {"circle_radius_m", thin.radius}});
  }
  return json;
}

Json describe_volume(const VolumeQuality& quality) {
  Json json{{"label", quality.label},
            {"balls", quality.spheres},
            {"voxels", quality.voxels},
            {"occupied_voxels", quality.occupied},
            {"voxel_volume_m3", quality.voxel_volume},
            {"exact", describe_exact(quality)},
            {"spacing", describe_spacing(quality.spacing)},
            {"not_searched", quality.not_searched},
            {"parts_voxels", quality.parts},
            {"holes", Json::array()},
            {"necks", Json::array()}};
  for (const VolumeHole& hole : quality.holes) {
    json["holes"].push_back({{"centroid", to_json(hole.centroid)},
                             {"inside", to_json(hole.inside)},
                             {"voxels", hole.voxels},
                             {"volume_m3", hole.volume},
                             {"voxels_beyond_balls", hole.beyond_spheres},
                             {"occupied_voxels", hole.occupied}});
  }
  for (const VolumeNeck& neck : quality.necks) {
    json["necks"].push_back({{"position", to_json(neck.position)},
                             {"radius_m", neck.radius},
                             {"smaller_part_radius_m", neck.smaller},
                             {"larger_part_radius_m", neck.larger}});
  }
  return json;
}

std::string litres(double cubic_metres) { return significant(cubic_metres * 1000.0, 4) + " l"; }

double number(const Json& json, const char* key) { return json[key].get<double>(); }

void add_exact(const Json& volume, std::vector<std::pair<std::string, std::string>>& rows) {
  const Json& exact = volume["exact"];
  if (exact.is_null()) {
    rows.emplace_back("exact balls", "not stored in this map");
    return;
  }
  rows.emplace_back("exact volume",
                    litres(number(exact, "volume_m3")) + " +- " + litres(number(exact, "volume_error_m3")));
  rows.emplace_back("not covered by voxels", litres(number(exact, "not_covered_m3")) + ", " +
                                                 significant(100.0 * number(exact, "not_covered_share"), 3) +
                                                 " %");
  rows.emplace_back("surface", significant(1e4 * number(exact, "surface_m2"), 4) + " cm2 +- " +
                                   significant(1e4 * number(exact, "surface_error_m2"), 2));
  rows.emplace_back("surface / volume", significant(number(exact, "surface_per_volume_1_m"), 3) +
                                            " per m; a ball of this volume has " +
                                            significant(100.0 * number(exact, "sphericity"), 3) +
                                            " % of the surface");
}

void add_spacing(const Json& spacing, std::vector<std::pair<std::string, std::string>>& rows) {
  rows.emplace_back("between balls", "median " + length_text(spacing["median_m"]) + " (" +
                                         significant(number(spacing, "median_over_radius"), 2) +
                                         " r0), largest " + length_text(spacing["largest_m"]) + " (" +
                                         significant(number(spacing, "largest_over_radius"), 2) + " r0)");
  rows.emplace_back("thin overlaps", grouped(spacing["thin"].size()));
  for (std::size_t i = 0; i < std::min(most_rows, spacing["thin"].size()); ++i) {
    const Json& thin = spacing["thin"][i];
    rows.emplace_back("  before ball " + std::to_string(thin["ball"].get<std::size_t>()),
                      "at " + point_text(thin["position"]) + ", " + length_text(thin["distance_m"]) +
                          " apart, circle of radius " + length_text(thin["circle_radius_m"]));
  }
}

void add_holes(const Json& volume, std::vector<std::pair<std::string, std::string>>& rows) {
  rows.emplace_back("holes", grouped(volume["holes"].size()));
  for (std::size_t i = 0; i < std::min(most_rows, volume["holes"].size()); ++i) {
    const Json& hole = volume["holes"][i];
    const auto beyond = hole["voxels_beyond_balls"].get<std::size_t>();
    const auto occupied = hole["occupied_voxels"].get<std::size_t>();
    std::string why = beyond > 0 ? grouped(beyond) + " beyond all balls" : "inside the balls";
    if (occupied > 0) why += ", " + grouped(occupied) + " sensed occupied";
    rows.emplace_back("  hole " + std::to_string(i + 1),
                      "at " + point_text(hole["centroid"]) + ", " +
                          counted(hole["voxels"].get<std::size_t>(), "voxel") + " = " +
                          significant(1e6 * number(hole, "volume_m3"), 3) + " cm3 (" + why + ")");
  }
}

void add_necks(const Json& volume, std::vector<std::pair<std::string, std::string>>& rows) {
  rows.emplace_back("thin necks", grouped(volume["necks"].size()));
  for (std::size_t i = 0; i < std::min(most_rows, volume["necks"].size()); ++i) {
    const Json& neck = volume["necks"][i];
    rows.emplace_back("  neck " + std::to_string(i + 1),
                      "at " + point_text(neck["position"]) + ", ball of radius " +
                          length_text(neck["radius_m"]) + " between parts of " +
                          length_text(neck["smaller_part_radius_m"]) + " and " +
                          length_text(neck["larger_part_radius_m"]));
  }
}

}  // namespace

Json describe_volumes(const Snapshot& map) {
  unsigned painted = 0;
  map.visit_leaves([&](const Voxel& leaf) { painted |= leaf.volumes; });
  Json json = Json::array();
  for (std::size_t i = 0; i < 15; ++i) {
    if (i >= map.volumes().size() && (painted >> i & 1U) == 0) continue;
    json.push_back(describe_volume(measure_volume(map, static_cast<int>(i))));
  }
  return json;
}

void print_volumes(const Json& json, std::ostream& out) {
  if (json.empty()) out << "\n  no painted volume in this map\n";
  for (const Json& volume : json) {
    std::vector<std::pair<std::string, std::string>> rows{
        {"painted volume", volume["label"].get<std::string>()},
        {"balls", grouped(volume["balls"].get<std::size_t>())},
        {"voxels",
         grouped(volume["voxels"].get<std::size_t>()) + " = " + litres(number(volume, "voxel_volume_m3"))}};
    add_exact(volume, rows);
    if (!volume["exact"].is_null()) add_spacing(volume["spacing"], rows);
    if (volume["not_searched"].get<std::string>().empty()) {
      rows.emplace_back("parts", grouped(volume["parts_voxels"].size()));
      add_holes(volume, rows);
      add_necks(volume, rows);
    } else {
      rows.emplace_back("holes and necks", "not searched: " + volume["not_searched"].get<std::string>());
    }
    out << '\n';
    print_rows(out, rows);
  }
}

}  // namespace clearway
