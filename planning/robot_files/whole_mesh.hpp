#pragma once

#include <cstddef>
#include <string>

namespace clearway {

/// assimp takes some mesh files that were cut off, believes counts that no file could hold, and says nothing
/// of data behind those that it counts. Checks that a .ply holds as many elements as its header says, and no
/// more; `plain_stl` looks at the end of .stl, and the other kinds (`dae`, `obj`) say nothing of their
/// length.
/// @throws std::runtime_error with the reason.
void check_mesh_is_whole(const std::string& content, const std::string& kind);

/// Bytes that the facets of a binary .stl take as its header counts them, or 0 where they are not there. What
/// some programs append, and assimp takes for a text, must not be whole facets.
/// @throws std::runtime_error where a second such file is appended: then the count is wrong
std::size_t binary_stl_bytes(const std::string& content);

}  // namespace clearway
