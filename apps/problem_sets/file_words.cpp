#include "apps/problem_sets/file_words.hpp"

namespace clearway {
namespace {

std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : name.substr(0, 60)) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '.' || c == '_' || c == '-' || c == '=';
    word += is_plain ? c : '_';
  }
  return word.empty() || word.front() == '.' ? "_" + word : word;
}

}  // namespace

std::string FileWords::of(const std::string& name) {
  std::string word = file_word(name);
  for (int number = 2; !taken_.insert(word).second; ++number)
    word = file_word(name) + "-" + std::to_string(number);
  return word;
}

}  // namespace clearway
