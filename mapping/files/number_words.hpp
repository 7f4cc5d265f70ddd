#pragma once

#include <optional>
#include <string_view>

namespace clearway {

/// Takes the next word off the beginning of a text, blanks before it too; empty at the end.
std::string_view next_word(std::string_view& text);

/// The number that a whole word is ("2m", "1,5" and "0x10" are none; "+1", "nan" and "inf" are), one that a
/// double can hold.
std::optional<double> parsed_number(std::string_view word);

}  // namespace clearway
