#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// A picture as the bytes of a file; `end` as ".png".
inline std::string picture_bytes(const cv::Mat& picture, const std::string& end) {
  std::vector<unsigned char> bytes;
  cv::imencode(end, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

inline std::string png_bytes(const GrayImage& image) {
  return picture_bytes(
      cv::Mat(image.height, image.width, CV_8UC1, const_cast<unsigned char*>(image.pixels.data())), ".png");
}

/// A JPEG of one grey with an EXIF block that says when it was taken ("2026:11:23 07:15:30"), by hand: TIFF,
/// little endian, IFD 0 with the pointer to the EXIF IFD, which has DateTimeOriginal and SubSecTimeOriginal
/// (three digits).
inline std::string jpeg_taken(const std::string& date, const std::string& milliseconds) {
  const auto u16 = [](unsigned value) {
    return std::string{static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
  };
  const auto u32 = [&](unsigned value) { return u16(value & 0xffff) + u16(value >> 16); };
  std::string tiff = "II" + u16(42) + u32(8);
  tiff += u16(1) + u16(0x8769) + u16(4) + u32(1) + u32(26) + u32(0);
  tiff += u16(2);
  tiff += u16(0x9003) + u16(2) + u32(20) + u32(56);
  tiff += u16(0x9291) + u16(2) + u32(4) + milliseconds + std::string(1, '\0');
  tiff += u32(0) + date + std::string(1, '\0');
  const std::string exif = std::string("Exif\0\0", 6) + tiff;
  const unsigned size = static_cast<unsigned>(exif.size()) + 2;
  const std::string segment =
      "\xff\xe1" + std::string{static_cast<char>(size >> 8), static_cast<char>(size & 0xff)} + exif;
  const std::string jpeg = picture_bytes(cv::Mat(40, 48, CV_8UC1, cv::Scalar(90)), ".jpg");
  return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

}  // namespace clearway
