#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "mapping/system/damaged_file.hpp"

namespace clearway {

/// Reads a map: a directory written by `clearway replay` (map.ot and painted.csv), or a .ot (ours or any
/// registered OctoMap tree), .bt, .pcd or .ply file. A bare tree has no exact spheres: then the voxels alone
/// decide. Points of a cloud, and the faces of a .ply, become occupied voxels of `cloud_resolution`,
/// metres; by default that of voxels_of_cloud().
/// @throws std::invalid_argument when the file is missing, unreadable or of an unknown kind.
/// @throws DamagedFile when it is truncated or corrupt; nothing half-read is ever returned.
Snapshot load_map(const std::filesystem::path& path, std::optional<double> cloud_resolution = {});

/// A map, and what else was read of it at the same moment.
struct LoadedMap {
  Snapshot map;
  std::string sha256;  ///< map_sha256 of the very bytes that `map` was read from
  /// By name, the bytes of those files beside a map.ot that were asked for and are there.
  std::map<std::string, std::string> beside = {};
};

/// A file to read beside a map.ot.
struct FileBeside {
  std::string name;
  std::string what;         ///< as errors call it
  std::size_t largest = 0;  ///< bytes
};

/// As load_map; the map, its digest and the files beside it are of one moment, whoever replaces the map or
/// its folder meanwhile: where that happens, all is read again, and in the end refused.
/// @param beside to be read when `path` is a map folder, or the map.ot in one
/// @throws also std::runtime_error when the map was replaced each time that it was read
LoadedMap load_map_with(const std::filesystem::path& path, const std::vector<FileBeside>& beside,
                        std::optional<double> cloud_resolution = {});

/// One sentence about the painted.csv beside a map in a folder, for whoever loaded `map` from `path`. A
/// map.ot of ours holds the painted volumes under its own seal, and painted.csv is a copy for spreadsheets:
/// when it differs, the sentence says that it is not used. A map.ot of another program has none: then
/// painted.csv is where they come from, and the sentence says so. Empty where there is nothing to say.
std::string painted_csv_remark(const std::filesystem::path& path, const Snapshot& map);

/// What a reader should know of the voxels that the points of a cloud became, for whoever loaded `map` from
/// `path`, one sentence: that they are not of the usual size, which nobody chose; that
/// some were filled between the points of surfaces thinned further; that at least a tenth of them touches
/// fewer than four others, so that surfaces may have holes; that its viewpoint is turned. Empty for other
/// maps.
std::string cloud_remark(const std::filesystem::path& path, const Snapshot& map, bool is_chosen);

/// Whether a file is a map.ot of ours, whatever its nodes may be worth.
bool is_own_map(const std::filesystem::path& file);

/// What save_map writes: each file's name and its bytes.
std::map<std::string, std::string> files_of_map(const Snapshot& map);

/// Writes DIR/map.ot and DIR/painted.csv, each to a temporary name, synced and renamed, and adds them to the
/// list of Clearway's files there (`.clearway_files`).
/// @throws std::runtime_error naming the file that could not be written; the old file is then intact.
void save_map(const Snapshot& map, const std::filesystem::path& directory);

/// Writes one file for other programs: .ot (octomap::ColorOcTree, coloured by state), .bt (occupied against
/// free), .pcd or .ply (centres of occupied and conflict voxels, PCL).
/// @throws std::invalid_argument for another extension, and for a cloud of a map without such voxels;
/// std::runtime_error when it cannot be written.
void export_map(const Snapshot& map, const std::filesystem::path& file);

/// SHA-256 of a file's bytes as 64 hexadecimal digits; for a map directory, of its map.ot, followed by those
/// of painted.csv where the painted volumes are from there (painted_csv_remark).
std::string map_sha256(const std::filesystem::path& path);

}  // namespace clearway
