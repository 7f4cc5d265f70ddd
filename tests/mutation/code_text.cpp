#include "tests/mutation/code_text.hpp"

#include <algorithm>
#include <regex>

namespace clearway::mutation {
namespace {

/// Where what begins at `at` and is no code ends; `at` itself where code stands.
std::size_t end_of_other(const std::string& source, std::size_t at) {
  const auto until = [&](const std::string& what) {
    const std::size_t end = source.find(what, at + 2);
    return end == std::string::npos ? source.size() : end;
  };
  if (source.compare(at, 2, "//") == 0) return until("\n");
  if (source.compare(at, 2, "/*") == 0) return std::min(until("*/") + 2, source.size());
  if (source.compare(at, 2, "R\"") == 0) {
    const std::string name = source.substr(at + 2, source.find('(', at) - at - 2);
    return std::min(until(")" + name + "\"") + name.size() + 2, source.size());
  }
  const char quote = source[at];
  const bool separates_digits = quote == '\'' && at > 0 && std::isdigit(source[at - 1]) != 0;
  if ((quote != '"' && quote != '\'') || separates_digits) return at;
  std::size_t end = at + 1;
  while (end < source.size() && source[end] != quote) end += source[end] == '\\' ? 2 : 1;
  return std::min(end + 1, source.size());
}

void blank(std::string& text, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i)
    if (text[i] != '\n') text[i] = ' ';
}

}  // namespace

std::string code_only(const std::string& source) {
  std::string code = source;
  for (std::size_t at = 0; at < source.size(); ++at) {
    const std::size_t end = end_of_other(source, at);
    if (end == at) continue;
    blank(code, at, end);
    at = end - 1;
  }
  // Nor is what sets flags of the compiler, or only fetches memory ahead: no result depends on it.
  static const std::regex no_statement(
      "(^|\n)([ ]*(#|static_assert|using |namespace |extern |template |HWY_\\w+_NAMESPACE\\()"
      "|[^\n]*__builtin_prefetch\\()[^\n]*");
  const std::string lines = code;
  for (std::sregex_iterator it(lines.begin(), lines.end(), no_statement), end; it != end; ++it)
    blank(code, static_cast<std::size_t>(it->position()),
          static_cast<std::size_t>(it->position() + it->length()));
  return code;
}

std::string line_at(const std::string& source, std::size_t at) {
  const std::size_t before = at == 0 ? std::string::npos : source.rfind('\n', at - 1);
  const std::size_t begin = source.find_first_not_of(" \n", before == std::string::npos ? 0 : before);
  return source.substr(begin, std::min(source.find('\n', at), source.size()) - begin);
}

int line_number(const std::string& source, std::size_t at) {
  return 1 +
         static_cast<int>(std::count(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace clearway::mutation
