#include "mapping/system/plain_text.hpp"

#include <gtest/gtest.h>

#include <random>

namespace clearway {
namespace plain_text_test {

TEST(PlainText, leaves_letters_of_any_language_and_escapes_what_moves_a_cursor) {
  EXPECT_EQ(plain("Würfel 1 µm → 家"), "Würfel 1 µm → 家");
  EXPECT_EQ(plain("a\n\tb\r"), "a\\n\\tb\\r");
  EXPECT_EQ(plain("\x1b[2J"), "\\x1b[2J");
  EXPECT_EQ(plain("\x7f"), "\\x7f");
  EXPECT_EQ(plain("\xc2\x9b"
                  "31m"),
            "\\xc2\\x9b31m");  // CSI of eight bits
  EXPECT_EQ(plain("\xe2\x80\xae"
                  "txt"),
            "\\xe2\\x80\\xaetxt");  // right to left
  EXPECT_EQ(plain(std::string_view("\0x", 2)), "\\x00x");
}

TEST(PlainText, escapes_bytes_that_are_no_utf8) {
  EXPECT_EQ(plain("\xff"), "\\xff");
  EXPECT_EQ(plain("\xc0\x80"), "\\xc0\\x80");           // longer than need be
  EXPECT_EQ(plain("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a pair
  EXPECT_EQ(plain("\xe2\x82"), "\\xe2\\x82");           // cut
  EXPECT_EQ(plain("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(PlainText, is_idempotent_and_holds_no_control_character_whatever_comes_in) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string text(random() % 20, '\0');
    for (char& c : text) c = static_cast<char>(random());
    const std::string shown = plain(text);
    for (const char c : shown) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
    EXPECT_EQ(plain(shown), shown);
  }
}

TEST(PlainText, what_is_quoted_from_a_file_is_cut_to_80_characters) {
  EXPECT_EQ(quote("beam"), "'beam'");
  EXPECT_EQ(quote(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(quote(std::string(81, 'x')), "'" + std::string(80, 'x') + "…'");
  EXPECT_EQ(quote(std::string(1000, '\x1b')).size(), 80 + 2 + std::string("…").size());
  EXPECT_EQ(shortened(std::string(5, '\n')), "\\n\\n\\n\\n\\n");
}

TEST(PlainText, what_is_quoted_shows_letters_of_any_language_and_no_control_of_eight_bits) {
  EXPECT_EQ(quote("Würfel → 家"), "'Würfel → 家'");
  EXPECT_EQ(quote("\x1b[2J\n"), "'\\x1b[2J\\n'");
  EXPECT_EQ(quote("\xc2\x9b"
                  "31m \xff \xe2\x80\xae"),
            "'\\xc2\\x9b31m \\xff \\xe2\\x80\\xae'");
}

TEST(PlainText, a_path_is_cut_to_its_last_255_characters) {
  EXPECT_EQ(quote_path(std::string(255, 'x')), "'" + std::string(255, 'x') + "'");
  EXPECT_EQ(quote_path("y" + std::string(255, 'x')), "'…" + std::string(255, 'x') + "'");
  EXPECT_EQ(quote_path(std::string(300, 'x') + "/家.yaml"), "'…" + std::string(248, 'x') + "/家.yaml'");
  EXPECT_EQ(quote_path(std::string(300, '\n') + "a"), "'…" + plain(std::string(127, '\n')) + "a'");
  EXPECT_EQ(quote_path(""), "''");
}

TEST(PlainText, the_first_byte_that_is_no_utf8_is_found) {
  EXPECT_EQ(first_not_utf8("caf\xc3\xa9"), std::string::npos);
  EXPECT_EQ(first_not_utf8("caf\xe9!"), 3U);
  EXPECT_EQ(first_not_utf8("\xc3\xa9\xc3"), 2U);
}

TEST(PlainText, lists_names_and_counts_the_rest_of_many) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a", "b\n"}), "a, b\\n");
  EXPECT_EQ(listed({std::string(100, 'x')}), std::string(80, 'x') + "…");
  EXPECT_TRUE(listed(std::vector<std::string>(27, "a")).ends_with("a, a and 7 more"));
}

TEST(PlainText, a_sentence_ends_once) {
  EXPECT_EQ(ended("it is so"), "it is so.");
  EXPECT_EQ(ended("it is so."), "it is so.");
  EXPECT_EQ(ended("is it?"), "is it?");
  EXPECT_EQ(ended(""), ".");
}

}  // namespace plain_text_test
}  // namespace clearway
