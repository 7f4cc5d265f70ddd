#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "planning/robot/robot.hpp"

namespace clearway {

/// As how many convex bodies at most each mesh of a link counts: one, but of all links or of some by name
/// more.
struct MeshPieces {
  std::size_t of_all = 1;
  std::map<std::string, std::size_t> of_link{};
};

/// Links, joints, masses and bodies of a URDF file (urdfdom), full size, base at the map's origin. Joints are
/// in the order in which a walk down the tree meets them, children in the order of the file. A body's part is
/// the name of its link. Nothing is exempt from contact yet, and the tip is the root.
/// A mimic joint whose axis differs from its master's keeps its own (Link::own_axis).
/// @throws std::invalid_argument in one sentence naming file, element and what was expected.
/// @param packages folders of packages, as find_mesh takes them
/// @param xacro arguments of a .xacro file @param pieces of links that are there and have a mesh
Robot read_urdf(const std::filesystem::path& file,
                const std::map<std::string, std::filesystem::path>& packages = {},
                const std::map<std::string, std::string>& xacro = {}, const MeshPieces& pieces = {});

}  // namespace clearway
