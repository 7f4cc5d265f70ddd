#include "apps/console/parse.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "apps/inspect/map_folder.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_edit.hpp"

namespace clearway {

Snapshot edited(const InspectOptions& options, const Snapshot& map) {
  const bool edits = !options.merge.empty() || !options.crop.empty() || options.coarsen.has_value();
  if (edits && options.save.empty())
    throw std::invalid_argument("--merge, --crop and --coarsen: expected --save DIR to write the new map to");
  Snapshot result = map;
  if (!options.merge.empty()) result = merge(result, load_map(options.merge, options.cloud_resolution));
  if (!options.crop.empty()) {
    const std::vector<double> n = parse_numbers(options.crop, "--crop");
    if (n.size() != 6)
      throw std::invalid_argument("--crop: expected X0,Y0,Z0,X1,Y1,Z1 in metres, got '" + options.crop + "'");
    result = crop(result, {Eigen::Vector3d(n[0], n[1], n[2]), Eigen::Vector3d(n[3], n[4], n[5])});
  }
  if (options.coarsen) result = coarsen(result, *options.coarsen);
  return result;
}

void save_edited(const InspectOptions& options, const Snapshot& map) {
  AtomicFolder folder(options.save, is_in_map_folder);
  save_map(map, folder.path());
  publish_map_folder(folder, map);
}

}  // namespace clearway
