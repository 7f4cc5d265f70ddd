#pragma once

#include <string_view>

namespace clearway {

/// The commit that the program was built from, "unknown" where there was no git.
std::string_view build_commit();

}  // namespace clearway
