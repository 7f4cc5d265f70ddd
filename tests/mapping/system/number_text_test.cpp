#include "mapping/system/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace clearway {
namespace number_text_test {

TEST(NumberText, OptionsReadBackToTheSameAndSentencesHaveFewDigits) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(std::vector<double>{1.0, 0.1 + 0.2}), "1,0.30000000000000004");
  EXPECT_EQ(short_text(0.67082), "0.6708");
  EXPECT_EQ(short_text(0.67082, 3), "0.671");
  EXPECT_EQ(short_text(1234567.0, 3), "1.23e+06");
  EXPECT_EQ(short_text(-0.5, 3), "-0.5");
  EXPECT_EQ(place_text(0.123456), "0.1235");
  EXPECT_EQ(place_text(-9.98765), "-9.988");
  EXPECT_EQ(place_text(30.12345), "30.123");
  EXPECT_EQ(place_text(-3001.4249), "-3001.425");
  EXPECT_EQ(place_text(1000.0), "1000");
  EXPECT_EQ(place_text(0.0), "0");
  EXPECT_EQ(place_text(HUGE_VAL), "inf");
}

TEST(NumberText, WhatIsCountedIsOneOrMany) {
  EXPECT_EQ(counted(0, "scan"), "0 scans");
  EXPECT_EQ(counted(1, "scan"), "1 scan");
  EXPECT_EQ(counted(1234567, "scan"), "1,234,567 scans");
  EXPECT_EQ(counted(1, "body", "bodies") + ", " + counted(2, "body", "bodies"), "1 body, 2 bodies");
}

TEST(NumberText, BesideALimitHasTheDigitsThatTellItFromThat) {
  EXPECT_EQ(text_beside(3.0, 2.0), "3");
  EXPECT_EQ(text_beside(2.0000001, 2.0), "2.0000001");
  EXPECT_EQ(text_beside(2.0 + 1e-10, 2.0), "2.0000000001");
  EXPECT_EQ(text_beside(2.0, 2.0), "2");
  EXPECT_EQ(text_beside(std::nan(""), 2.0), "nan");
}

}  // namespace number_text_test
}  // namespace clearway
