#pragma once

#include <string>

namespace clearway {

/// assimp takes some mesh files that were cut off, and believes counts that no file could hold. Checks that
/// a .ply holds as many elements as its header says, and that the text of a .stl has its end; the other
/// kinds (`dae`, `obj`) say nothing of their length. @throws std::runtime_error with the reason.
void check_mesh_is_whole(const std::string& content, const std::string& kind);

}  // namespace clearway
