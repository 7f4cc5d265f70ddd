#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// The known name that takes the fewest insertions, deletions and replacements to reach from `name`; the
/// first of equals; empty when nothing is known.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// The known name that `name` is a slip of: the same letters in another case or order, or at most two (for a
/// known name of four letters or fewer: one) insertions, deletions and replacements.
/// Empty when `name` is known itself, or resembles none.
std::string misspelt_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace clearway
