#pragma once

#include <string>

namespace clearway::mutation {

/// The source with everything that is not code turned into spaces: comments, string and character literals,
/// preprocessor lines, static assertions. Of the same length, with the same line ends.
std::string code_only(const std::string& source);

/// The line that holds this place, without the spaces around it, and its number from 1.
std::string line_at(const std::string& source, std::size_t at);
int line_number(const std::string& source, std::size_t at);

}  // namespace clearway::mutation
