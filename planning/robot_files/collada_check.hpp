#pragma once

#include <string>

namespace tinyxml2 {
class XMLElement;
}

namespace clearway {

/// assimp leaves out bodies that nodes place and are not in the file once, as a <mesh> of faces or lines, and
/// takes those of skins as they stand, whatever their matrix. @param root of a .dae
/// @throws std::runtime_error with a clause that names the element
void check_collada_instances(const tinyxml2::XMLElement& root);

/// assimp takes any number for the unit of a .dae, and reads beyond the vertices that are there where counts
/// and strides say so, leaves out what nodes place and is not in the file, and turns about axes as long as
/// they are. Checks the unit of length, how the positions of vertices are cut up, and what nodes name.
/// @returns the file, axes of rotations of length 1
/// @throws std::runtime_error with a clause that names the element and its attribute
std::string checked_collada(const std::string& content);

}  // namespace clearway
