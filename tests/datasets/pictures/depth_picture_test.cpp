#include "datasets/pictures/depth_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace depth_picture_test {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

cv::Mat_<float> reals() { return (cv::Mat_<float>(2, 3) << 1.5, 0, nan, -2, inf, 70000.25); }
const std::vector<float> expected_reals{1.5F, 0, 0, 0, 0, 70000.25F};

/// By hand: from the lowest row.
std::string pfm(bool is_big_endian) {
  const cv::Mat_<float> rows = reals();
  std::string bytes = is_big_endian ? "Pf\n3 2\n1.0\n" : "Pf\n3 2\n-1.0\n";
  for (const int row : {1, 0})
    for (int column = 0; column < 3; ++column) {
      std::string number(reinterpret_cast<const char*>(&rows(row, column)), 4);
      if (is_big_endian) std::reverse(number.begin(), number.end());
      bytes += number;
    }
  return bytes;
}

TEST(DepthPictureFile, WholeNumbersAreSteps) {
  const cv::Mat_<std::uint16_t> steps = (cv::Mat_<std::uint16_t>(2, 3) << 0, 1, 1000, 65534, 65535, 7);
  for (const char* end : {".png", ".pgm", ".tiff"}) {
    const DepthPicture picture = decode_depth_picture(picture_bytes(steps, end));
    EXPECT_EQ(picture.size, (ImageSize{3, 2})) << end;
    EXPECT_FALSE(picture.is_real) << end;
    EXPECT_EQ(picture.values, (std::vector<float>{0, 1, 1000, 65534, 0, 7})) << end;
  }
  cv::Mat_<int> wide;
  steps.convertTo(wide, CV_32S);
  wide(0, 2) = 100000;
  EXPECT_EQ(decode_depth_picture(picture_bytes(wide, ".tiff")).values,
            (std::vector<float>{0, 1, 100000, 65534, 0, 7}));
}

TEST(DepthPictureFile, RealNumbersAreThemselvesAndWhatIsNoDistanceIsNone) {
  for (const std::string& bytes : {picture_bytes(reals(), ".tiff"), pfm(false), pfm(true)}) {
    const DepthPicture picture = decode_depth_picture(bytes);
    EXPECT_EQ(picture.size, (ImageSize{3, 2})) << bytes.substr(0, 2);
    EXPECT_TRUE(picture.is_real) << bytes.substr(0, 2);
    EXPECT_EQ(picture.values, expected_reals) << bytes.substr(0, 2);
  }
}

TEST(DepthPictureFile, WhatHoldsNoDepthIsRefusedInAClause) {
  const auto said = [](const std::string& bytes) {
    return complaint<std::runtime_error>([&] { decode_depth_picture(bytes); });
  };
  const cv::Mat grey(2, 3, CV_8UC1, cv::Scalar(9)), colours(2, 3, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_NE(said(picture_bytes(grey, ".png")).find("16 bits"), std::string::npos);
  EXPECT_NE(said(picture_bytes(colours, ".png")).find("16 bits"), std::string::npos);
  EXPECT_NE(said("nothing").find("cannot be decoded"), std::string::npos);
  const cv::Mat_<float> before = (cv::Mat_<float>(2, 3) << -1.5, nan, -2, -3, -2.5, -1),
                        none = (cv::Mat_<float>(2, 3) << -1, -2, nan, -1, 0, -2);
  EXPECT_NE(said(picture_bytes(before, ".tiff")).find("all its depths are negative"), std::string::npos);
  EXPECT_EQ(said(picture_bytes(none, ".tiff")), "");  // numbers for what is not known
  const std::string whole = pfm(false);
  for (std::size_t size = 2; size < whole.size(); ++size) EXPECT_NE(said(whole.substr(0, size)), "") << size;
  EXPECT_NE(said("Pf\n-3 2\n-1.0\n").find("-3 x 2 pixels"), std::string::npos);
  EXPECT_NE(said("Pf\n3000000 2000000\n-1.0\n").find("pixels, expected"), std::string::npos);
  EXPECT_NE(said("Pf\n3 2\n0\n").find("head"), std::string::npos);
  EXPECT_NE(said(whole + "1").find("25 bytes of numbers, expected 24"), std::string::npos);
}

TEST(DepthPictureFile, LinesOfAPfmsHeadMayEndAsWindowsEndsThem) {
  std::string bytes = pfm(false);
  bytes.replace(bytes.find("-1.0\n"), 5, "-1.0\r\n");
  EXPECT_EQ(decode_depth_picture(bytes).values, expected_reals);
}

TEST(DepthPictureFile, TheHeadOfEachKindIsFound) {
  const TemporaryFolder folder;
  const cv::Mat_<std::uint16_t> steps(2, 3, std::uint16_t{9});
  folder.write("a.png", picture_bytes(steps, ".png"));
  folder.write("b.tiff", picture_bytes(steps, ".tiff"));
  folder.write("c.pfm", pfm(false));
  folder.write("d.npy", "\x93NUMPY");
  for (const char* name : {"a.png", "b.tiff", "c.pfm"}) {
    const auto head = depth_picture_head({folder / name});
    ASSERT_TRUE(head) << name;
    EXPECT_EQ(head->size, (ImageSize{3, 2})) << name;
    EXPECT_EQ(head->is_real, name[0] == 'c') << name;
  }
  EXPECT_FALSE(depth_picture_head({folder / "d.npy"}));
  EXPECT_FALSE(depth_picture_head({folder / "none.npy"}));
  EXPECT_FALSE(depth_picture_head({}));
  const auto second = depth_picture_head({folder / "d.npy", folder / "none.npy", folder / "c.pfm"});
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->is_real);
}

}  // namespace depth_picture_test
}  // namespace clearway
