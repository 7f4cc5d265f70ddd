#include "apps/inspect/map_folder.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

bool is_in_saved_map(const std::filesystem::path& relative) {
  constexpr std::array names = {"map.ot", "painted.csv", "seen.bin", "queries.json"};
  return std::find(names.begin(), names.end(), relative) != names.end();
}

bool is_in_map_folder(const std::filesystem::path& relative) {
  constexpr std::array names = {"provenance.bin", "report.json", "report.html"};
  if (is_in_saved_map(relative) || std::find(names.begin(), names.end(), relative) != names.end())
    return true;
  return relative.parent_path() == "plans" && relative.extension() == ".json";
}

void require_no_foreign_map(const std::string& flag, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path map = folder / "map.ot";
  if (std::filesystem::exists(folder / own_files_name, error) || !std::filesystem::exists(map, error) ||
      is_own_map(map))
    return;
  throw std::invalid_argument(flag + ": " + quote_path(folder.string()) +
                              " holds a map.ot that Clearway did not write and would replace, expected "
                              "another folder");
}

void require_saved_map_place(const std::string& flag, const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path name = entry.path().filename();
    if (name == "plans" || (is_in_map_folder(name) && !is_in_saved_map(name)))
      throw std::invalid_argument(flag + ": " + quote_path(folder.string()) + " holds " +
                                  quote(name.string()) +
                                  ", which is no part of a saved map, expected another folder");
  }
  require_no_foreign_map(flag, folder);
  AtomicFolder(folder, is_in_saved_map);
}

void save_map_folder(const std::filesystem::path& place, const Snapshot& map,
                     std::optional<QueryRecord> record) {
  AtomicFolder folder(place, is_in_saved_map);
  save_map(map, folder.path());
  if (record) {
    record->map_sha256 = map_sha256(map);
    save_file(folder.path() / "queries.json", to_json(*record));
  }
  publish_map_folder(folder, map);
}

void publish_map_folder(AtomicFolder& folder, const Snapshot& map) {
  load_map(folder.path());  // throws what a later reader would
  if (map_sha256(folder.path()) != map_sha256(map))
    throw std::runtime_error("'" + (folder.path() / "map.ot").string() +
                             "' reads back as another map than was written: is the disk sound?");
  folder.publish();
}

}  // namespace clearway
