#include "tests/mutation/reach.hpp"

#include <fstream>
#include <sstream>
#include <vector>

#include "tests/mutation/code_text.hpp"

namespace clearway::mutation {
namespace {

constexpr std::size_t none = std::string::npos;

bool begins_with_word(const std::string& code, std::size_t at, const std::string& word) {
  if (code.compare(at, word.size(), word) != 0) return false;
  const char behind = at + word.size() < code.size() ? code[at + word.size()] : ' ';
  return std::isalnum(static_cast<unsigned char>(behind)) == 0 && behind != '_';
}

/// Behind the colon of the label that begins at `at`.
std::size_t behind_label(const std::string& code, std::size_t at) {
  for (std::size_t i = code.find(':', at); i != none; i = code.find(':', i + 2))
    if (code.compare(i, 2, "::") != 0) return i + 1;
  return none;
}

/// By place: where the innermost bracket that is open there stands; none where none is.
std::vector<std::size_t> innermost_brackets(const std::string& code) {
  std::vector<std::size_t> inside(code.size() + 1, none), open;
  for (std::size_t i = 0; i < code.size(); ++i) {
    inside[i] = open.empty() ? none : open.back();
    if (std::string("([{").find(code[i]) != std::string::npos) open.push_back(i);
    if (std::string(")]}").find(code[i]) != std::string::npos && !open.empty()) open.pop_back();
  }
  return inside;
}

}  // namespace

const char* const declares_probes = "extern \"C\" void clearway_reached(int);\n";

std::size_t place_of_probe(const std::string& source, std::size_t at) {
  const std::string code = code_only(source);
  const std::vector<std::size_t> inside = innermost_brackets(code);
  std::set<std::size_t> blocks;  // that hold the fault
  for (std::size_t i = at; i > 0; i = inside[i] == none ? 0 : inside[i]) blocks.insert(inside[i]);
  for (std::size_t i = at; i > 0; --i) {
    const bool is_between_statements = std::string(";{}").find(code[i - 1]) != std::string::npos;
    if (!is_between_statements || inside[i] == none || code[inside[i]] != '{' || !blocks.contains(inside[i]))
      continue;
    std::size_t place = i, next = code.find_first_not_of(" \n", place);
    while (begins_with_word(code, next, "case") || begins_with_word(code, next, "default")) {
      place = behind_label(code, next);
      if (place > at) return none;
      next = code.find_first_not_of(" \n", place);
    }
    if (!begins_with_word(code, next, "else")) return place;
  }
  return none;
}

std::string with_probe(const std::string& source, std::size_t place, int number) {
  return std::string(source).insert(place, " ::clearway_reached(" + std::to_string(number) + ");");
}

void Reach::read(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string suite;
    double time = 0.0;
    if (!(words >> suite >> time)) continue;
    times[suite] += time;
    for (int probe = 0; words >> probe;) suites[probe].insert(suite);
  }
}

}  // namespace clearway::mutation
