#include "datasets/poses/word_lines.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace clearway {

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<WordLine> word_lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<WordLine> lines;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    if (auto words = words_in(line); !words.empty()) lines.push_back({number, std::move(words)});
  }
  return lines;
}

}  // namespace clearway
