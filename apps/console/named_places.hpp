#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// A file or folder, and the flag or argument that names it.
struct NamedPlace {
  std::string flag;
  std::filesystem::path path;  ///< empty: the flag was not given
};

/// Nothing that is read is overwritten. An output must not be an input, by whatever link, nor one of the
/// files that are read with a folder (a map's or a session's), nor the folder of a map.ot or painted.csv that
/// is an input. What is not there (the names of cameras, robots and shipped files among them) is nobody's.
/// @throws std::invalid_argument naming both.
void require_apart(const std::vector<NamedPlace>& outputs, const std::vector<NamedPlace>& inputs);

/// The files that belong to a robot: the one that names it, and the description, settings and SRDF of the
/// same name beside it. None of a robot that is no file.
std::vector<NamedPlace> places_of_robot(const std::string& flag, const std::filesystem::path& robot);

/// Nothing in the folder of a recording is overwritten: its pictures, tables and parts of a bag are read.
/// @param folder of an input; one that is no folder holds nothing
/// @throws std::invalid_argument for an output that is a file there, naming both
void require_not_in(const std::vector<NamedPlace>& outputs, const NamedPlace& folder);

}  // namespace clearway
