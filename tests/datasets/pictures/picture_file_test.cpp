#include "datasets/pictures/picture_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace picture_file_test {

std::string refusal(const std::string& bytes) {
  try {
    decode_picture(bytes);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PictureFile, APngGivesItsPixelsAndColoursBecomeTheirLuma) {
  cv::Mat grey(33, 45, CV_8UC1);
  for (int i = 0; i < 33 * 45; ++i) grey.data[i] = static_cast<unsigned char>(i * 7);
  const GrayImage image = decode_picture(picture_bytes(grey, ".png"));
  EXPECT_EQ(image.width, 45);
  EXPECT_EQ(image.height, 33);
  EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), grey.data));
  // ITU-R BT.601: 0.299 R + 0.587 G + 0.114 B
  const cv::Mat colour(4, 4, CV_8UC3, cv::Scalar(200, 100, 50));
  EXPECT_NEAR(decode_picture(picture_bytes(colour, ".png")).pixels[5], 0.299 * 50 + 0.587 * 100 + 0.114 * 200,
              1.0);
  const cv::Mat deep(4, 4, CV_16UC1, cv::Scalar(200 * 256));
  EXPECT_EQ(decode_picture(picture_bytes(deep, ".png")).pixels[5], 200);
  cv::Mat dim(4, 4, CV_16UC1, cv::Scalar(2048));  // of a camera of 12 bits
  dim.at<std::uint16_t>(0, 0) = 4095;
  for (const char* end : {".png", ".tiff"})
    EXPECT_EQ(decode_picture(picture_bytes(dim, end)).pixels[5], 128) << end;
}

TEST(PictureFile, NoCutOfAPictureIsTakenForAWholeOne) {
  cv::Mat noise(64, 64, CV_8UC1);
  cv::randu(noise, 0, 255);
  for (const char* end : {".png", ".jpg"}) {
    const std::string whole = picture_bytes(noise, end);
    ASSERT_EQ(refusal(whole), "") << end;
    for (std::size_t size = 0; size + 2 < whole.size(); size += 97)
      EXPECT_NE(refusal(whole.substr(0, size)), "") << end << ", " << size << " of " << whole.size();
  }
}

TEST(PictureFile, TheEndOfAPreviewIsNotTheEndOfThePicture) {
  const std::string whole = picture_bytes(cv::Mat(40, 40, CV_8UC1, cv::Scalar(9)), ".jpg");
  const std::string preview = std::string("\xff\xe1\x00\x06", 4) + "\xff\xd9zz";
  const std::string with = whole.substr(0, 2) + preview + whole.substr(2);
  EXPECT_TRUE(is_whole(with));
  EXPECT_FALSE(is_whole(with.substr(0, with.size() - 20)));
}

TEST(PictureFile, AnOrientationInExifDoesNotTurnThePixels) {
  // IFD 0 with Orientation = 6 alone
  const std::string tiff("II\x2a\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 26);
  const std::string exif = std::string("\xff\xe1\x00\x22", 4) + std::string("Exif\0\0", 6) + tiff;
  const std::string whole = picture_bytes(cv::Mat(20, 60, CV_8UC1, cv::Scalar(9)), ".jpg");
  const std::string turned = whole.substr(0, 2) + exif + whole.substr(2);
  const std::vector<unsigned char> bytes(turned.begin(), turned.end());
  ASSERT_EQ(cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).cols, 20);  // OpenCV's default turns it
  EXPECT_EQ(decode_picture(turned).width, 60);
}

TEST(PictureFile, RefusesSidesThatNoCameraHas) {
  EXPECT_NE(refusal(picture_bytes(cv::Mat(1, 20001, CV_8UC1, cv::Scalar(0)), ".png")).find("20001 x 1"),
            std::string::npos);
  EXPECT_NE(refusal("no picture"), "");
}

TEST(PictureFile, ExifStatesWhenItWasTaken) {
  // 2001-09-09 01:46:40 UTC is 1,000,000,000 s after 1970.
  EXPECT_NEAR(exif_time(jpeg_taken("2001:09:09 01:46:40", "250")), 1e9 + 0.25, 1e-6);
  EXPECT_LT(exif_time(jpeg_taken("2001:19:09 01:46:40", "250")), 0.0);
  EXPECT_LT(exif_time(jpeg_taken("nobody knows it yet", "250")), 0.0);
  EXPECT_LT(exif_time(picture_bytes(cv::Mat(8, 8, CV_8UC1, cv::Scalar(1)), ".jpg")), 0.0);
  EXPECT_LT(exif_time("no picture"), 0.0);
}

TEST(PictureSize, IsThatOfTheHeadOfAPngJpegOrPgm) {
  const TemporaryFolder folder;
  for (const char* end : {".png", ".jpg", ".pgm"}) {
    const std::string bytes = picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(7)), end);
    EXPECT_EQ(picture_size(folder.write("whole", bytes)), (ImageSize{48, 36})) << end;
    for (std::size_t size = 0; size < 12 && std::string(end) != ".pgm"; ++size)
      EXPECT_FALSE(picture_size(folder.write("cut", bytes.substr(0, size)))) << end << size;
  }
  EXPECT_EQ(picture_size(folder.write("taken.jpg", jpeg_taken("2026:11:23 07:15:30", "250"))),
            (ImageSize{48, 40}))
      << "behind EXIF";
  EXPECT_FALSE(picture_size(folder.write("j", std::string("\xff\xd8\xff\xc0\0\x0b\x08\0\0\0\0\0\0", 13))));
  for (const std::size_t side : {16, 20}) {  // none is 0
    std::string png = picture_bytes(cv::Mat(36, 48, CV_8UC1, cv::Scalar(7)), ".png");
    png.replace(side, 4, 4, '\0');
    EXPECT_FALSE(picture_size(folder.write("none_wide.png", png))) << side;
  }
  EXPECT_FALSE(picture_size(folder / "none.png"));
}

}  // namespace picture_file_test
}  // namespace clearway
