#pragma once

#include <string>
#include <string_view>

namespace clearway {

/// What a file says, fit for a sentence of ours: between single quotes, cut after 80 characters with "…", and
/// with control characters and bytes outside of ASCII that are no UTF-8 as \xNN, so that nothing in it moves
/// a terminal's cursor. (mapping/plain_text.hpp does the same for the floors that may include it.)
std::string shown(std::string_view text);

/// A path in the same way, but up to 255 characters of it.
std::string shown_path(std::string_view path);

/// Whether a text would be shown as it is: nothing escaped in it.
bool is_plain(std::string_view text);

}  // namespace clearway
