#pragma once

#include <string>

namespace clearway {

/// assimp takes "2m" for 2 and "1,5" for 1. Checks that the coordinates of vertices in the text of an .obj,
/// .ply or .stl file are numbers, as those of clouds and robots have to be; `check_collada` does so for .dae.
/// @throws std::runtime_error naming the line and the word
void check_numbers_of_mesh(const std::string& content, const std::string& kind);

}  // namespace clearway
