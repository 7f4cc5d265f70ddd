#include "datasets/depth_files/npy_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "datasets/pictures/depth_picture.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/npy_bytes.hpp"

namespace clearway {
namespace npy_file_test {

/// What numpy.save (1.24) wrote, its blanks apart: 118 bytes of head end with a line feed.
std::string file(std::string head, const std::string& data) {
  head.resize(117, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + data;
}

const std::string reals = file("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }",
                               std::string("\x00\x00\x00\x00\x00\x00\xc0?\x00\x00\x10@\x00\x00\xc0\x7f"
                                           "\x00\x00\x80@\x00\x00\xa0@",
                                           24));

TEST(NpyFile, RealNumbersStandRowByRow) {
  EXPECT_TRUE(is_npy(reals));
  EXPECT_FALSE(is_npy("\x89PNG"));
  const DepthPicture picture = decode_npy(reals);
  EXPECT_EQ(picture.size, (ImageSize{2, 3}));
  EXPECT_TRUE(picture.is_real);
  ASSERT_EQ(picture.values.size(), 6U);
  EXPECT_TRUE(std::isnan(picture.values[3]));
  EXPECT_EQ(picture.values[1], 1.5F);
  EXPECT_EQ(picture.values[2], 2.25F);
  EXPECT_EQ(picture.values[5], 5.0F);
}

TEST(NpyFile, FortransOrderAndTheOtherOrderOfBytesAreHeard) {
  const DepthPicture picture =
      decode_npy(file("{'descr': '>u2', 'fortran_order': True, 'shape': (2, 3), }",
                      std::string("\x03\xe8\x0f\xa0\x07\xd0\x13\x88\x0b\xb8\0\0", 12)));
  EXPECT_EQ(picture.size, (ImageSize{3, 2}));
  EXPECT_FALSE(picture.is_real);
  EXPECT_EQ(picture.values, (std::vector<float>{1000, 2000, 3000, 4000, 5000, 0}));
}

/// As the picture that it was made of.
TEST(NpyFile, TheLargestNumberOf16BitsIsNone) {
  const std::string data("\xff\xff\xfe\xff", 4);
  EXPECT_EQ(
      decode_depth_picture(file("{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2), }", data)).values,
      (std::vector<float>{0, 65534}));
  const std::string real("\0\xff\x7f\x47\0\xfe\x7f\x47", 8);  // the same, as somebody keeps them in floats
  EXPECT_EQ(
      decode_depth_picture(file("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }", real)).values,
      (std::vector<float>{0, 65534}));
}

TEST(NpyFile, AnAxisOfOneEntryIsNone) {
  const std::string data("\x00>\x00\x34", 4);  // 1.5, 0.25
  for (const char* shape : {"(1, 2, 1)", "(1, 1, 2)", "(1, 2)"}) {
    const DepthPicture picture = decode_npy(
        file("{'descr': '<f2', 'fortran_order': False, 'shape': " + std::string(shape) + ", }", data));
    EXPECT_EQ(picture.size, (ImageSize{2, 1})) << shape;
    EXPECT_EQ(picture.values, (std::vector<float>{1.5F, 0.25F})) << shape;
  }
}

TEST(NpyFile, NumbersOfEveryWidthAreRead) {
  const std::vector<std::pair<const char*, std::string>> types{
      {"<i2", std::string("\x05\0", 2)},
      {">i4", std::string("\0\0\0\x05", 4)},
      {"<u4", std::string("\x05\0\0\0", 4)},
      {"<i8", std::string("\x05\0\0\0\0\0\0\0", 8)},
      {">u8", std::string("\0\0\0\0\0\0\0\x05", 8)},
      {"<f8", std::string("\0\0\0\0\0\0\x14\x40", 8)},
      {">f8", std::string("\x40\x14\0\0\0\0\0\0", 8)}};
  for (const auto& [type, data] : types)
    EXPECT_EQ(
        decode_npy(
            file("{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (1, 1), }", data))
            .values,
        std::vector<float>{5.0F})
        << type;
}

/// Version 2 has four bytes for the size of its head.
TEST(NpyFile, LaterVersionsAreRead) {
  const std::string second = std::string("\x93NUMPY\x02\x00\x76\x00\x00\x00", 12) + reals.substr(10);
  EXPECT_EQ(decode_npy(second).values[4], 4.0F);
}

TEST(NpyFile, WhatIsNoPictureIsRefusedInAClause) {
  const auto said = [](const std::string& bytes) {
    return complaint<std::runtime_error>([&] { decode_npy(bytes); });
  };
  const auto head = [](const std::string& type, const std::string& shape) {
    return file("{'descr': " + type + ", 'fortran_order': False, 'shape': " + shape + ", }",
                std::string(64, '\0'));
  };
  for (std::size_t size = 6; size < reals.size(); ++size) EXPECT_NE(said(reals.substr(0, size)), "") << size;
  EXPECT_NE(said(head("'<f4'", "(4, 4, 3)")).find("an array of 4 x 4 x 3 entries"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "(16,)")).find("an array of 16 entries"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "()")).find("of no entries"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "(0, 4)")).find("sides"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "(-4, 4)")).find("no shape"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "(99999999999999999999, 4)")).find("no shape"), std::string::npos);
  EXPECT_NE(said(head("'<f4'", "(4000000000, 4000000000)")).find("sides"), std::string::npos);
  EXPECT_NE(said(head("'<c8'", "(2, 2)")).find("type '<c8'"), std::string::npos);
  for (const char* type : {"'|u1'", "'|i1'", "'|b1'"})
    EXPECT_NE(said(head(type, "(8, 8)")).find("its numbers have 8 bits"), std::string::npos) << type;
  EXPECT_NE(said(head("'|O'", "(2, 2)")).find("type '|O'"), std::string::npos);
  EXPECT_NE(said(head("[('a', '<f4')]", "(2, 2)")).find("records"), std::string::npos);
  EXPECT_NE(said(file("{'descr': '<f4'}", "")).find("names no 'fortran_order'"), std::string::npos);
}

/// A number counts its place in C's order, whatever the order of the file.
TEST(NpyFile, NumbersOfAnyShapeStandInTheOrderOfC) {
  for (const bool is_fortran : {false, true}) {
    std::vector<std::int32_t> values(24);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 4; ++k) {
          const std::size_t c = (i * 3 + j) * 4 + k, fortran = (k * 3 + j) * 2 + i;
          values[is_fortran ? fortran : c] = static_cast<std::int32_t>(c);
        }
    const NpyNumbers numbers = decode_npy_numbers(npy_bytes("<i4", "(2, 3, 4)", values, is_fortran), 24);
    EXPECT_EQ(numbers.shape, (std::vector<std::int64_t>{2, 3, 4}));
    EXPECT_EQ(numbers.shape_text, "2 x 3 x 4");
    EXPECT_EQ(numbers.type, "i4");
    ASSERT_EQ(numbers.values.size(), 24U);
    for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(numbers.values[i], static_cast<double>(i));
  }
  EXPECT_EQ(decode_npy_numbers(npy_bytes("<f8", "()", std::vector<double>{0.1}), 1).values.at(0), 0.1);
  EXPECT_TRUE(decode_npy_numbers(npy_bytes("<f8", "(0, 4)", std::vector<double>()), 1).values.empty());
}

TEST(NpyFile, MoreNumbersThanAreWantedOrThereAreRefused) {
  const auto said = [](const char* shape, std::size_t most) {
    const std::string bytes = npy_bytes("<f8", shape, std::vector<double>(4));
    return complaint<std::runtime_error>([&] { decode_npy_numbers(bytes, most); });
  };
  EXPECT_EQ(said("(4,)", 4), "");
  EXPECT_EQ(said("(4,)", 3), "it is an array of 4 entries, expected at most 3");
  EXPECT_EQ(said("(5,)", 9), "it is cut off");
  EXPECT_NE(said("(4000000000, 4000000000, 4000000000)", 1U << 30U).find("expected at most"),
            std::string::npos);
  EXPECT_EQ(said("(0, 9000000000000000000, 9)", 9), "");
}

}  // namespace npy_file_test
}  // namespace clearway
