#pragma once

#include <cstddef>
#include <string>

namespace clearway {

/// assimp takes some mesh files that were cut off, believes counts that no file could hold, and says nothing
/// of data behind those that it counts. Checks that a .ply holds as many elements as its header says, and no
/// more, and that the text of a .stl has its end; the other kinds (`dae`, `obj`) say nothing of their length.
/// @throws std::runtime_error with the reason.
void check_mesh_is_whole(const std::string& content, const std::string& kind);

/// Bytes of a .stl without what some programs append to its facets, which assimp takes for a text.
std::size_t whole_stl(const std::string& content);

/// How many facets a .stl holds, of all its solids and beside them. @pre check_mesh_is_whole takes it
std::size_t facets_of_stl(const std::string& content);

}  // namespace clearway
