#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace clearway {

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

}  // namespace clearway
