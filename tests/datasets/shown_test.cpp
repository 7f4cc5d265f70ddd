#include "datasets/shown.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace {

TEST(Shown, cuts_to_80_characters_and_escapes_what_moves_a_cursor) {
  EXPECT_EQ(shown("Würfel → 家"), "'Würfel → 家'");
  EXPECT_EQ(shown("\x1b[2J\n"), "'\\x1b[2J\\x0a'");
  EXPECT_EQ(shown("\xc2\x9b"
                  "31m \xff \xe2\x80\xae"),
            "'\\xc2\\x9b31m \\xff \\xe2\\x80\\xae'");
  EXPECT_EQ(shown(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(shown(std::string(90, 'x')), "'" + std::string(80, 'x') + "…'");
  EXPECT_EQ(shown_path(std::string(200, 'x')).size(), 202u);
  EXPECT_TRUE(is_plain("Würfel"));
  EXPECT_FALSE(is_plain("a\x7f"));
}

}  // namespace
}  // namespace clearway
