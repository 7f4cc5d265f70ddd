#include "apps/console/flag_names.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace clearway {
namespace {

bool is_flag_letter(char c) { return std::islower(static_cast<unsigned char>(c)) != 0 || c == '-'; }

/// Of "NAME=VALUE" or "NAME:=VALUE" at the begin of a text as a dictionary of Python; empty: it is none.
/// @param length of what was read
std::string dictionary_at(std::string_view text, std::size_t& length) {
  length = std::min(text.find_first_of(" ,;)"), text.size());
  const std::string_view word = text.substr(0, length);
  const std::size_t equals = word.find('=');
  if (equals == std::string_view::npos || equals == 0) return "";
  const std::size_t name = word[equals - 1] == ':' ? equals - 1 : equals;
  return "={'" + std::string(word.substr(0, name)) + "': " + std::string(word.substr(equals + 1)) + "}";
}

}  // namespace

std::string with_names(const std::string& sentence, const FlagNames& names) {
  const std::string_view text = sentence;
  std::string said;
  for (std::size_t at = 0; at < text.size();) {
    const bool begins =
        text.substr(at).starts_with("--") && (at == 0 || text[at - 1] == ' ' || text[at - 1] == '(');
    std::size_t end = at;
    while (begins && end < text.size() && is_flag_letter(text[end])) ++end;
    const auto known = names.find(text.substr(at, end - at));
    if (known == names.end()) {
      said += text[at++];
      continue;
    }
    said += known->second;
    at = end;
    std::size_t length = 0;
    const std::string dictionary =
        at < text.size() && text[at] == ' ' ? dictionary_at(text.substr(at + 1), length) : "";
    if (dictionary.empty()) continue;
    said += dictionary;
    at += 1 + length;
  }
  return said;
}

std::string with_keys(const std::string& sentence) {
  static const FlagNames keys{{"--fix", "fixed"},
                              {"--group", "group"},
                              {"--srdf", "srdf"},
                              {"--package", "packages"},
                              {"--xacro", "xacro"},
                              {"--scale", "scale"},
                              {"--base", "base"},
                              {"--tip", "tip"},
                              {"--policy", "policies"},
                              {"--padding", "padding"},
                              {"--seen-within", "seen_within"},
                              {"--allow-outside", "allow_outside"}};
  return with_names(sentence, keys);
}

}  // namespace clearway
