#include "datasets/yaml/yaml_gate.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace clearway {
namespace yaml_gate_test {

std::string refusal(const std::string& text, const YamlBounds& bounds = {}) {
  try {
    require_yaml(text, "suite 's'", bounds);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

TEST(YamlGate, what_an_alias_repeats_counts_as_often_as_it_is_repeated) {
  EXPECT_EQ(refusal("a: &a [1, 2]\nb: [*a, *a]\n"), "accepted");
  std::string bomb = "a: &a [1,1,1,1,1,1,1,1,1,1]\n";
  for (const char* pair : {"ab", "bc", "cd", "de", "ef"}) {
    bomb += std::string(1, pair[1]) + ": &" + pair[1] + " [" +
            repeated("*" + std::string(1, pair[0]) + ",", 10) + "]\n";
  }
  EXPECT_NE(refusal(bomb).find("at most 250006 words"), std::string::npos) << refusal(bomb);
  EXPECT_NE(refusal("a: &a [*a]\n").find("complete before it"), std::string::npos);
  EXPECT_NE(refusal("[" + repeated("0,", 280'000) + "0]").find("at most 267500 words"), std::string::npos);
  EXPECT_EQ(refusal("[" + repeated("-0.12345678901234567,", 400'000) + "0]"),
            "accepted");  // a long trajectory
}

/// Short numbers that a file holds may be many where its reader expects them, but no more repeated ones.
TEST(YamlGate, what_a_file_holds_and_what_aliases_repeat_have_bounds_of_their_own) {
  const YamlBounds dense{.nodes = 500'000, .advice = "; fewer points"};
  EXPECT_EQ(refusal("[" + repeated("0,", 280'000) + "0]", dense), "accepted");
  EXPECT_NE(refusal("[" + repeated("0,", 550'000) + "0]", dense)
                .find("at most 534375 words, lists and maps in a file of this size, repeated ones included; "
                      "fewer points."),
            std::string::npos);
  const std::string bomb = "a: &a [" + repeated("0,", 999) + "0]\nb: [" + repeated("*a,", 300) + "*a]\n";
  EXPECT_NE(refusal(bomb, dense).find("expected aliases to repeat at most 2500"), std::string::npos)
      << refusal(bomb, dense);
}

/// `ros2 topic echo` ends each message with "---": one is a document, of two the second would be lost.
TEST(YamlGate, several_documents_are_refused_with_their_count) {
  for (const char* one :
       {"a: 1\n", "a: 1\n---\n", "---\na: 1\n", "a: 1\n---\n---\n", "---\na: 1\n...\n", "", "---\n"})
    EXPECT_EQ(refusal(one), "accepted") << one;
  EXPECT_EQ(refusal("a: 1\n---\nb: 2\n---\n"),
            "suite 's', line 2, column 1: expected one document, got 2, of which the second begins here.");
  EXPECT_NE(refusal("a: 1\n---\nb: 2\n---\n[]\n---\n").find("got 3,"), std::string::npos);
  EXPECT_NE(refusal("---\n---\na: 1\n").find("got 2,"), std::string::npos);
  EXPECT_NE(refusal("a: 1\n---\nb: [\n").find("not valid YAML"), std::string::npos);
  for (const char* stray : {"[1]\n]\n", "{a: 1}}\n", "[1]: [2]]\n"})  // yaml-cpp sees documents without end
    EXPECT_NE(refusal(stray), "accepted") << stray;
}

TEST(YamlGate, deep_nesting_is_refused_whichever_way_it_is_written) {
  EXPECT_EQ(refusal(repeated("[", 32) + repeated("]", 32)), "accepted");
  for (const std::string& text :
       {repeated("[", 100'000), repeated("{a: ", 50'000), repeated("- ", 100'000), repeated("? ", 50'000)})
    EXPECT_NE(refusal(text).find("at most 32 lists and maps inside each other"), std::string::npos);
}

TEST(YamlGate, a_quoted_text_that_the_file_does_not_end_is_refused_where_it_begins) {
  for (const char quote : {'"', '\''}) {
    const std::string mark(1, quote);
    EXPECT_EQ(refusal("a: 1\nb: " + mark + "open\nc:\n  - d: 2\n"),
              "suite 's', line 2, column 4: not valid YAML, expected this quoted text to end.");
    EXPECT_EQ(refusal("[1, " + mark + "open"),
              "suite 's', line 1, column 10: not valid YAML, expected a quoted text to end.");
    EXPECT_EQ(refusal("a: " + mark + "b\n---\nc: d\n"),
              "suite 's', line 2, column 1: not valid YAML, expected a quoted text to end before '---'.");
    for (const char* end : {"", "\n", "\n...\n", "\n---\n", "\n# it's\n"})
      EXPECT_EQ(refusal("a: " + mark + "two\n lines" + mark + end), "accepted") << end;
  }
  for (const std::string text : {"a: it's", "a: |\n  \"open\n", "a: 5\" pipe\n", "# \"\n", "", "--- \n...\n"})
    EXPECT_EQ(refusal(text), "accepted") << text;
}

TEST(YamlGate, names_line_column_and_what_was_expected_in_our_words) {
  EXPECT_EQ(refusal("a: [1, 2\n"), "suite 's', line 2, column 1: not valid YAML, expected ',' or ']'.");
  EXPECT_EQ(
      refusal("a: b: c\n"),
      "suite 's', line 1, column 5: not valid YAML, expected no second ': ' in a value without quotes.");
  EXPECT_EQ(refusal("a: *b\n"),
            "suite 's', line 1, column 4: not valid YAML, expected an alias of what is named before it.");
}

}  // namespace yaml_gate_test
}  // namespace clearway
