#pragma once

#include <map>
#include <string_view>

namespace clearway {

/// The documentation comments of public headers, by "Class::member" or "function", in words of Python. The
/// source is made by docstrings.py when the module is built.
const std::map<std::string_view, const char*>& header_comments();

/// The docstring of what the headers call `name`, then what only Python's callers need to know. Lives as long
/// as the program. @throws std::logic_error, when the module is imported, for a name without a comment
const char* doc(std::string_view name, std::string_view python = {});

}  // namespace clearway
