#pragma once

#include <string>

namespace clearway {

/// assimp takes any number for the unit of a .dae, and reads beyond the vertices that are there where counts
/// and strides say so. Checks the unit of length and how the positions of vertices are cut up.
/// @throws std::runtime_error with a clause that names the element and its attribute
void check_collada(const std::string& content);

}  // namespace clearway
