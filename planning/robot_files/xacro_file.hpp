#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "planning/robot_files/mesh_file.hpp"

namespace clearway {

/// Values of the arguments of a xacro file (<xacro:arg>) by their names.
using XacroArguments = std::map<std::string, std::string>;

/// Whether an argument may have this name: letters, digits and underscores.
bool is_xacro_name(const std::string& name);

/// The URDF that the program `xacro` (of the PATH) makes of a file; each argument is passed on as
/// NAME:=VALUE. It runs in a child that may take 1 GB and 20 s and can write no file.
/// @throws std::invalid_argument naming the file when an argument's name is none, there is no such program,
///         it refuses the file, or its URDF has more than `largest` bytes.
std::string expanded_xacro(const std::filesystem::path& file, std::size_t largest,
                           const XacroArguments& arguments = {});

/// A sentence for each argument that neither the file nor one that it includes declares (<xacro:arg>) or uses
/// ($(arg NAME)), with the name that is meant. None where an include cannot be found, as it may declare it.
std::vector<std::string> xacro_notes(const std::filesystem::path& file, const XacroArguments& arguments,
                                     const PackageFolders& packages = {});

}  // namespace clearway
