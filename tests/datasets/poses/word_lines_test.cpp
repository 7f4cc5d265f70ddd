#include "datasets/poses/word_lines.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace word_lines_test {

TEST(WordLines, HoldWordsAndTheirNumberInTheFile) {
  const auto lines = word_lines("# head\n1 2\t3 # rest\r\n\n  \nlast");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].number, 2);
  EXPECT_EQ(lines[0].words, (std::vector<std::string>{"1", "2", "3"}));
  EXPECT_EQ(lines[1].number, 5);
  EXPECT_EQ(lines[1].words, std::vector<std::string>{"last"});
  EXPECT_TRUE(word_lines("").empty());
}

}  // namespace word_lines_test
}  // namespace clearway
