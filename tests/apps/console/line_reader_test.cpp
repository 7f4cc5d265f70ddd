#include "apps/console/line_reader.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace clearway {
namespace line_reader_test {

std::vector<std::string> lines_of(const std::string& text, std::size_t most) {
  std::istringstream in(text);
  LineReader reader(in, most);
  std::vector<std::string> lines;
  while (const auto line = reader.next()) lines.push_back(line->is_too_long ? "TOO LONG" : line->text);
  return lines;
}

using Lines = std::vector<std::string>;

TEST(LineReader, GivesEachLineAlsoEmptyOnesAndALastOneWithoutItsEnd) {
  EXPECT_EQ(lines_of("", 10), Lines{});
  EXPECT_EQ(lines_of("a", 10), Lines{"a"});
  EXPECT_EQ(lines_of("a\n\nbc\n", 10), (Lines{"a", "", "bc"}));
  EXPECT_EQ(lines_of(std::string("a\0b\n", 4), 10), Lines{std::string("a\0b", 3)});
}

TEST(LineReader, ReportsALineThatIsTooLongAndGoesOnBehindIt) {
  EXPECT_EQ(lines_of("1234\n12345\n123\n" + std::string(100000, 'x'), 4),
            (Lines{"1234", "TOO LONG", "123", "TOO LONG"}));
}

TEST(LineReader, AStreamWithoutABufferIsAtItsEnd) {
  std::istream nothing(nullptr);
  EXPECT_FALSE(LineReader(nothing, 10).next());
}

}  // namespace line_reader_test
}  // namespace clearway
