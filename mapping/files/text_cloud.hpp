#pragma once

#include <filesystem>

namespace clearway {

/// PCL takes words that are no numbers ("2m", "1,5", "abc") for 0, for a number before them or for no point,
/// and fills up with zeros what was cut off. Checks that the header of a .pcd or .ply file ends, of text data
/// every word of every line; `nan` and `inf` are numbers and say that nothing was met. Of binary data it
/// checks that nothing follows what the header counts.
/// @throws std::runtime_error with a clause that names the line
void check_data_of_cloud(const std::filesystem::path& file, bool is_pcd);

}  // namespace clearway
