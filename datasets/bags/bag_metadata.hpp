#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// The names, without folders, of the files of a ROS 2 bag that its metadata.yaml lists
/// (rosbag2_bagfile_information: relative_file_paths); none when it has no such list.
/// @param folder of the bag @throws std::invalid_argument naming the file, the line and what was expected.
std::vector<std::string> listed_parts(const std::filesystem::path& folder);

/// @throws std::invalid_argument naming the folder where metadata.yaml says that its files, or its messages,
/// are compressed, and saying how they are unpacked; files that lie there unpacked do, those of SQLite, which
/// are read as they are (Zstandard), and messages packed by Zstandard.
void require_unpacked(const std::filesystem::path& folder);

}  // namespace clearway
