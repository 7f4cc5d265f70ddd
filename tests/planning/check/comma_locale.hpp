#pragma once

#include <gtest/gtest.h>

#include <locale>
#include <string>

namespace clearway {

/// While it exists, streams write 1.5 as "1,5" and 12 as "1'2" unless they are told otherwise.
class CommaLocale {
 public:
  CommaLocale() : before_(std::locale::global(std::locale(std::locale::classic(), new Commas))) {}
  ~CommaLocale() { std::locale::global(before_); }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '\''; }
    std::string do_grouping() const override { return "\1"; }
  };
  std::locale before_;
};

/// The sentence that `say` returns, which must hold `part`, is the same in every locale.
template <class Say>
void expect_same_in_every_locale(const Say& say, const std::string& part) {
  const std::string sentence = say();
  EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  const CommaLocale commas;
  EXPECT_EQ(say(), sentence);
}

}  // namespace clearway
