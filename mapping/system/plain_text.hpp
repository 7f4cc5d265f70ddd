#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace clearway {

// What a file says may hold anything: terminal commands, half a megabyte on one line. These make it fit for a
// sentence.

/// The text with nothing in it that moves a terminal's cursor or hides what is there: control characters
/// (C0, DEL, C1), marks that turn the direction of writing, and bytes that are no UTF-8 become \n, \t, \xNN.
std::string plain(std::string_view text);

/// Where the first byte is that is no UTF-8; npos when there is none.
std::size_t first_not_utf8(std::string_view text);

/// Plain, and cut after 80 characters with "…".
std::string shortened(std::string_view text);

/// Shortened, between single quotes.
std::string quote(std::string_view text);

/// Names, each shortened, with commas; of more than twenty the first ones "and 7 more".
std::string listed(const std::vector<std::string>& names);

/// The sentence with a full stop, unless it ends in one or in a question mark.
std::string ended(std::string sentence);

/// A path, plain, between single quotes; of a longer one the last 255 characters, with the file's name.
std::string quote_path(std::string_view path);

}  // namespace clearway
