#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// The known name that takes the fewest insertions, deletions and replacements to reach from `name`; the
/// first of equals; empty when nothing is known.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace clearway
