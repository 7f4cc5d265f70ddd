#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace clearway {

constexpr std::size_t most_yaml_nodes = 250'000;  ///< of a file that somebody writes

/// How many words, lists and maps a YAML text may hold.
struct YamlBounds {
  std::size_t nodes = most_yaml_nodes;     ///< and one per 32 bytes, with what aliases repeat
  std::size_t repeated = most_yaml_nodes;  ///< by aliases alone, and one per 32 bytes
  std::string advice{};                    ///< ends the sentence about a file that holds more of its own
};

/// Refuses a YAML text that would take far more memory or time than its size: more words, lists and maps than
/// `bounds` (what an alias repeats counts as often as it is repeated), more than 32 of them inside each
/// other, an alias within what it names; and several documents, but for empty ones at the end. Words for what
/// yaml-cpp does not understand are ours.
/// @throws std::invalid_argument "<name>, line 3, column 7: <what was expected>."
void require_yaml(const std::string& text, const std::string& name, const YamlBounds& bounds = {});

/// A whole text file that somebody writes. @throws std::invalid_argument, saying `what` it should have been,
/// when it cannot be read or is larger than 4 MB.
std::string read_text(const std::filesystem::path& file, const std::string& what);

}  // namespace clearway
