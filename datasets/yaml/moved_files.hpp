#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// In double quotes, as YAML reads it back.
std::string yaml_quoted(const std::string& text);

/// Whether a robot's name is that of a file, relative to the folder of what names it, not of one of ours.
bool is_description_file(const std::string& robot);

/// A setup's text for another folder: the files that it names relative to its own are named as they are seen
/// from there, all else stays as it is. @throws std::invalid_argument for a name that is not on one line
std::string with_files_from(const std::string& setup, const std::filesystem::path& folder,
                            const std::filesystem::path& other);

}  // namespace clearway
