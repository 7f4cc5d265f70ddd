#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Insertions, deletions and replacements of a byte that make `b` of `a` (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name that goes on where `name` ends, or the other way round (rate, rate_hz); else the one that
/// takes the fewest insertions, deletions and replacements to reach from `name`; the first of equals; empty
/// when none is within `most` of them.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known,
                         std::size_t most = std::numeric_limits<std::size_t>::max());

/// The known name that `name` is a slip of: the same letters in another case or order, or at most two (for a
/// known name of four letters or fewer: one) insertions, deletions and replacements.
/// Empty when `name` is known itself, or resembles none.
std::string misspelt_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace clearway
