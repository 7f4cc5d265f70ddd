#pragma once

#include <string>
#include <vector>

namespace clearway {

/// A line that holds something, and its number in the file, from 1.
struct WordLine {
  int number;
  std::vector<std::string> words;
};

/// What stands of a text's lines before `#`, in words apart by blanks; lines without any are left out.
std::vector<WordLine> word_lines(const std::string& text);

/// The words of a text.
std::vector<std::string> words_in(const std::string& text);

}  // namespace clearway
