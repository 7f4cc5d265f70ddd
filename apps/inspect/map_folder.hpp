#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mapping/snapshot.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "planning/files/query_record.hpp"

namespace clearway {

/// Whether a file, relative to a map folder, is one that `inspect --save` writes: a folder with others has
/// more than a map.
bool is_in_saved_map(const std::filesystem::path& relative);

/// Whether a file, relative to a map folder, is one that `replay` writes, or `inspect --save`.
bool is_in_map_folder(const std::filesystem::path& relative);

/// @throws std::invalid_argument where a folder, that `flag` names, holds a map.ot of another program, which
///         the new one would replace.
void require_no_foreign_map(const std::string& flag, const std::filesystem::path& folder);

/// @throws std::invalid_argument where a folder, that `flag` names, holds more than a saved map, which would
/// be
///         that of another map then, or a map.ot of another program; std::runtime_error as AtomicFolder, for
///         one that cannot be replaced as a whole.
void require_saved_map_place(const std::string& flag, const std::filesystem::path& folder);

/// Writes the map into a folder that then takes the place of `folder` as a whole, with the record of the
/// queries of the map that it was made of. @throws as publish_map_folder
void save_map_folder(const std::filesystem::path& folder, const Snapshot& map,
                     std::optional<QueryRecord> record);

/// Reads the map that was saved in `folder` again, and lets the folder take its place when it is `map`.
/// @throws std::runtime_error naming the folder; what was there before is then untouched.
void publish_map_folder(AtomicFolder& folder, const Snapshot& map);

}  // namespace clearway
