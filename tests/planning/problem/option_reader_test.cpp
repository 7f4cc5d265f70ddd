#include "planning/problem/option_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

namespace clearway {
namespace option_reader_test {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(OptionReader, KeepsDefaultsAndPrintsWhatIsInForce) {
  OptionReader reader("beam", {{"width", "7"}, {"step", "0.1, 0.2"}, {"empty", ""}});
  EXPECT_EQ(reader.integer("width", 10, 1, 100), 7);
  EXPECT_EQ(reader.number("ratio", 0.3, 0.0, 1.0), 0.3);
  EXPECT_EQ(reader.number("empty", 2.0, 0.0, 9.0), 2.0);
  EXPECT_EQ(reader.number_or_auto("max_step", 0.0, 0.0, 1.0), 0.0);
  EXPECT_EQ(reader.numbers_or_auto("step", {}, 0.0, 1.0), (std::vector<double>{0.1, 0.2}));
  EXPECT_TRUE(reader.flag("last_segment", true));
  reader.refuse_unknown();
  const std::map<std::string, std::string> expected = {{"width", "7"},      {"ratio", "0.3"},
                                                       {"empty", "2"},      {"max_step", "auto"},
                                                       {"step", "0.1,0.2"}, {"last_segment", "true"}};
  EXPECT_EQ(reader.in_force(), expected);
}

TEST(OptionReader, PrintedOptionsReadBackToTheSame) {
  OptionReader first("x", {{"a", "0.1234567890123456"}, {"b", "off"}, {"c", "1e-3,2"}});
  first.number("a", 0.0, 0.0, 1.0), first.flag("b", true), first.numbers_or_auto("c", {}, 0.0, 9.0);
  first.integer_or_auto("d", 0, 1, 9);
  OptionReader second("x", first.in_force());
  second.number("a", 0.0, 0.0, 1.0), second.flag("b", true), second.numbers_or_auto("c", {}, 0.0, 9.0);
  second.integer_or_auto("d", 0, 1, 9);
  EXPECT_EQ(first.in_force(), second.in_force());
}

TEST(OptionReader, NamesOptionValueAndRange) {
  OptionReader reader(
      "beam",
      {{"width", "0"}, {"ratio", "0.5x"}, {"flag", "maybe"}, {"side", "left"}, {"k", "2.5"}, {"n", "nan"}});
  EXPECT_EQ(message_of([&] { reader.integer("width", 10, 1, 100); }),
            "beam: option 'width' is '0': expected a whole number from 1 to 100");
  EXPECT_EQ(message_of([&] { reader.number("ratio", 0.3, 0.0, 1.0); }),
            "beam: option 'ratio' is '0.5x': expected a number from 0 to 1");
  EXPECT_EQ(message_of([&] { reader.flag("flag", true); }),
            "beam: option 'flag' is 'maybe': expected true or false");
  EXPECT_EQ(message_of([&] {
              reader.choice("side", "upper", {"upper", "lower"});
            }),
            "beam: option 'side' is 'left': expected upper or lower");
  EXPECT_EQ(message_of([&] { reader.integer("k", 1, 1, 9); }),
            "beam: option 'k' is '2.5': expected a whole number from 1 to 9");
  EXPECT_NE(message_of([&] { reader.number("n", 1, 0, 9); }), "nothing thrown");
}

TEST(OptionReader, PrintsLargeBoundsDigitByDigit) {
  OptionReader reader("beam", {{"width", "0"}, {"max_steps", "1.5"}, {"scale", "-1"}, {"step", "0.1,99"}});
  EXPECT_EQ(message_of([&] { reader.integer("width", 10, 1, 100000); }),
            "beam: option 'width' is '0': expected a whole number from 1 to 100000");
  EXPECT_EQ(message_of([&] { reader.integer_or_auto("max_steps", 0, 1, 100000000); }),
            "beam: option 'max_steps' is '1.5': expected auto or a whole number from 1 to 100000000");
  EXPECT_EQ(message_of([&] { reader.number_or_auto("scale", 0.0, 0.0, 1e6); }),
            "beam: option 'scale' is '-1': expected auto or a number from 0 (automatic, too) to 1000000");
  EXPECT_EQ(message_of([&] { reader.numbers_or_auto("step", {}, 1e-6, 10.0); }),
            "beam: option 'step' is '99': expected auto or numbers from 1e-06 to 10, separated by commas");
  EXPECT_EQ(reader.integer("max_samples", 100000, 1, 100000000), 100000);
  EXPECT_EQ(reader.in_force().at("max_samples"), "100000");
}

TEST(OptionReader, NoughtIsAutomaticWhereAutoIsAndPrintedSo) {
  OptionReader reader("beam", {{"prismatic_scale", "0"}});
  EXPECT_EQ(reader.number_or_auto("prismatic_scale", 0.0, 0.0, 1e6), 0.0);
  EXPECT_EQ(reader.in_force().at("prismatic_scale"), "auto");
}

TEST(OptionReader, ValuesOfTheStructStandWhereNoTextIsAndAreCheckedAsText) {
  OptionReader reader("beam", {{"width", "7"}, {"scale", "auto"}});
  EXPECT_EQ(reader.integer("width", 10, 1, 100), 7);
  EXPECT_EQ(reader.number_or_auto("scale", 3.0, 0.0, 1e6), 0.0);
  EXPECT_EQ(reader.number_or_auto("range", 3.0, 0.0, 1e6), 3.0);
  EXPECT_EQ(reader.integer_or_auto("max_steps", 5, 1, 9), 5);
  EXPECT_EQ(reader.numbers_or_auto("step", {0.1, 0.2}, 0.0, 1.0), (std::vector<double>{0.1, 0.2}));
  const std::map<std::string, std::string> expected = {
      {"width", "7"}, {"scale", "auto"}, {"range", "3"}, {"max_steps", "5"}, {"step", "0.1,0.2"}};
  EXPECT_EQ(reader.in_force(), expected);
  EXPECT_EQ(message_of([&] { reader.integer("k", 0, 1, 9); }),
            "beam: option 'k' is '0': expected a whole number from 1 to 9");
  EXPECT_EQ(message_of([&] { reader.number("x", std::nan(""), 0.0, 1.0); }),
            "beam: option 'x' is 'nan': expected a number from 0 to 1");
  EXPECT_EQ(message_of([&] { reader.number_or_auto("y", -1.0, 0.0, 1.0); }),
            "beam: option 'y' is '-1': expected auto or a number from 0 (automatic, too) to 1");
  EXPECT_EQ(message_of([&] { reader.integer_or_auto("n", -3, 1, 9); }),
            "beam: option 'n' is '-3': expected auto or a whole number from 1 to 9");
  EXPECT_EQ(message_of([&] {
              reader.numbers_or_auto("z", {0.5, 2.0}, 0.0, 1.0);
            }),
            "beam: option 'z' is '2': expected auto or numbers from 0 to 1, separated by commas");
}

TEST(OptionReader, UnknownOptionNamesTheNearest) {
  OptionReader reader("beam", {{"widht", "3"}});
  reader.integer("width", 10, 1, 100);
  reader.flag("last_segment", true);
  EXPECT_EQ(message_of([&] { reader.refuse_unknown(); }),
            "beam: unknown option 'widht': did you mean 'width'?");
}

}  // namespace option_reader_test
}  // namespace clearway
