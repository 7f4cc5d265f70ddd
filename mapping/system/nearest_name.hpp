#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Insertions, deletions and replacements of a byte, and swaps of neighbours, that make `b` of `a` (optimal
/// string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name that goes on where `name` ends, or ends in it as a word, or the other way round (rate,
/// rate_hz); else the one that takes the fewest edits to reach, in whatever case, at most one for each three
/// letters of the shorter one; else the one whose last word is so near where one of the two is a single word
/// (panda_hnd, hand); the first of equals; empty when none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// The end of a sentence about a name that is not known: "did you mean 'beam'?" where one is near, else
/// "expected one of" all of them, or "expected none".
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

/// The known name that `name` is a slip of: the same letters in another case or order, or at most two (for a
/// known name of four letters or fewer: one) insertions, deletions and replacements.
/// Empty when `name` is known itself, or resembles none.
std::string misspelt_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace clearway
