#include "planning/files/json_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

namespace clearway {
namespace json_text_test {

std::string refusal(const std::string& text) {
  try {
    require_json(text, "'p.json'");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

/// In a text of one line, which may be any line of a stream, no line is named.
std::string at(int column, const std::string& expected, const std::string& line = "") {
  return "'p.json' is not valid JSON at " + line + "column " + std::to_string(column) + ": expected " +
         expected;
}

TEST(JsonText, names_the_place_and_what_should_have_come_there) {
  EXPECT_EQ(refusal(""), at(1, "a value"));
  EXPECT_EQ(refusal("{\"a\": 1,\n \"b\" 2}"), at(6, "':' and a value", "line 2, "));
  EXPECT_EQ(refusal("{\"a\": }"), at(7, "a value"));
  EXPECT_EQ(refusal("{\"a\": 1 \"b\""), at(9, "',' and a key in quotes, or '}'"));
  EXPECT_EQ(refusal("{a: 1}"), at(2, "a key in quotes, or '}'"));
  EXPECT_EQ(refusal("[1,,2]"), at(4, "a value"));
  EXPECT_EQ(refusal("[1 2]"), at(4, "',' and a value, or ']'"));
  EXPECT_EQ(refusal("[1]]"), at(4, "nothing more"));
  EXPECT_EQ(refusal("[1e999]"), at(2, "a number that is not too large"));
}

/// Of a key that an object has twice readers take the one or the other.
TEST(JsonText, a_key_that_an_object_has_twice_is_named) {
  EXPECT_EQ(refusal("{\"a\": {\"x\": 1}, \"b\": {\"x\": 1, \"y\": 2, \"x\": 3}}"),
            "'p.json' has key 'x' twice in one object, expected it once");
  EXPECT_EQ(refusal("{\"a\": 1, \"\\u0061\": 1}"),
            "'p.json' has key 'a' twice in one object, expected it once");
  EXPECT_EQ(refusal("[{\"a\": {\"a\": 1}}, {\"a\": 1, \"A\": 1}]"), "accepted");
}

TEST(JsonText, bytes_that_are_no_utf8_are_located) {
  EXPECT_EQ(refusal("{\"a\": \"caf\xe9\"}"), at(11, "text in UTF-8"));
  EXPECT_EQ(refusal("{\n\"\xff\": 1}"), at(2, "text in UTF-8", "line 2, "));
  EXPECT_EQ(refusal("[\"caf\xc3\xa9\", ]"), at(11, "a value"));
}

TEST(JsonText, says_nothing_in_the_parsers_words_whatever_comes_in) {
  const std::string whole = R"({"robot": "x", "joints": ["a", "b"], "n": [1, -2.5e3, true, null], "o": {}})";
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string text = whole;
    for (unsigned k = 1 + random() % 3; k > 0; --k)
      text[random() % text.size()] = i % 2 == 0 ? static_cast<char>(random()) : "[]{},:\"0e-"[random() % 10];
    const std::string sentence = refusal(text);
    EXPECT_EQ(sentence == "accepted", nlohmann::json::accept(text)) << text;
    for (const char* internal : {"json.exception", "syntax error", "literal", "unexpected", "U+"})
      EXPECT_EQ(sentence.find(internal), std::string::npos) << sentence;
  }
}

TEST(JsonText, what_would_exhaust_the_stack_or_the_memory_is_refused) {
  EXPECT_EQ(refusal(std::string(64, '[') + std::string(64, ']')), "accepted");
  EXPECT_NE(refusal(std::string(65, '[') + std::string(65, ']')).find("at most 64 arrays"),
            std::string::npos);
  EXPECT_NE(refusal(std::string(100'000, '[')).find("at most 64 arrays"), std::string::npos);
  std::string many = "[";
  for (int i = 0; i < 1'000'000; ++i) many += "{},";
  EXPECT_NE(refusal(many + "0]").find("at most 1,000,000"), std::string::npos);
}

}  // namespace json_text_test
}  // namespace clearway
