#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace clearway {

/// True for a name that ends in .xyz, .asc or .pts, in small or capital letters.
bool is_xyz_file(const std::filesystem::path& file);

/// Reads the finite points of a text that has a line for each, as CloudCompare, Leica's and surveyors'
/// programs write them: x, y, z (m) and any other columns, apart by blanks, by commas or by semicolons,
/// whichever the first point shows. Empty lines and those that begin with `#` or `//` are left out. A head,
/// commented out or not, may say in which columns x, y and z are; a first line with one whole number says how
/// many points follow.
/// @throws std::invalid_argument when there is no such file, it has more than 4 GB or holds no point;
///         DamagedFile naming the line that is none of these.
std::vector<Eigen::Vector3f> read_xyz_file(const std::filesystem::path& file);

}  // namespace clearway
