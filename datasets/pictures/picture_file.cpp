#include "datasets/pictures/picture_file.hpp"

#include <libexif/exif-data.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "datasets/cameras/packed_pixels.hpp"
#include "datasets/pictures/name_time.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

struct ExifDeleter {
  void operator()(ExifData* data) const { exif_data_unref(data); }
};

std::string exif_text(ExifData& data, ExifTag tag) {
  ExifEntry* entry = exif_content_get_entry(data.ifd[EXIF_IFD_EXIF], tag);
  if (entry == nullptr) return "";
  std::array<char, 64> text{};
  exif_entry_get_value(entry, text.data(), text.size());
  return text.data();
}

std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
  int value = 0;
  if (at + count > text.size()) return std::nullopt;
  const auto end = std::from_chars(text.data() + at, text.data() + at + count, value);
  if (end.ec != std::errc() || end.ptr != text.data() + at + count || value < 0) return std::nullopt;
  return value;
}

/// "2026:11:23 07:15:30"
std::optional<double> seconds_of_exif(std::string_view text) {
  const auto year = digits(text, 0, 4), month = digits(text, 5, 2), day = digits(text, 8, 2),
             hour = digits(text, 11, 2), minute = digits(text, 14, 2), second = digits(text, 17, 2);
  if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
  return seconds_of_date(*year, *month, *day, *hour, *minute, *second);
}

/// "25" is a quarter of a second.
double fraction_of(std::string_view text) {
  double value = 0.0, unit = 0.1;
  for (const char c : text) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) break;
    value += unit * (c - '0');
    unit /= 10.0;
  }
  return value;
}

/// After "P5" two numbers, apart by blanks and comments.
std::optional<ImageSize> pgm_size(const std::string& head) {
  std::array<int, 2> sides{};
  std::size_t at = 2;
  for (int& side : sides) {
    while (at < head.size() && (std::isspace(static_cast<unsigned char>(head[at])) != 0 || head[at] == '#'))
      at = head[at] == '#' ? std::min(head.find('\n', at), head.size()) : at + 1;
    const auto end = std::from_chars(head.data() + at, head.data() + head.size(), side);
    if (end.ec != std::errc() || side < 1 || side > longest_side) return std::nullopt;
    at = static_cast<std::size_t>(end.ptr - head.data());
  }
  return ImageSize{sides[0], sides[1]};
}

/// What a JPEG's start of frame says: a segment FF C0 to FF CF, but for C4, C8 and CC, before the pixels.
std::optional<ImageSize> jpeg_size(const std::string& head) {
  const auto byte = [&](std::size_t at) { return static_cast<int>(static_cast<unsigned char>(head[at])); };
  for (std::size_t at = 2; at + 9 <= head.size() && byte(at) == 0xff;) {
    const int kind = byte(at + 1);
    if (kind == 0xff) {
      ++at;  // fill
      continue;
    }
    if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
      const ImageSize size{256 * byte(at + 7) + byte(at + 8), 256 * byte(at + 5) + byte(at + 6)};
      const bool is_size =
          size.width > 0 && size.height > 0 && size.width <= longest_side && size.height <= longest_side;
      return is_size ? std::optional(size) : std::nullopt;
    }
    if (kind == 0xda) return std::nullopt;  // pixels
    at += 2 + static_cast<std::size_t>(256 * byte(at + 2) + byte(at + 3));
  }
  return std::nullopt;
}

}  // namespace

bool is_picture_file(const std::filesystem::path& file) {
  const std::string end = extension_of(file);
  const auto all = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".ppm"};
  return std::find(all.begin(), all.end(), end) != all.end();
}

std::optional<ImageSize> picture_size(const std::filesystem::path& file) {
  std::string head;
  try {
    InputFile(file, "picture").read_at(0, 256, head);
    constexpr std::size_t jpeg_reach = 512U << 10U;  // bytes, within which its EXIF and profiles end
    if (head.starts_with("\xff\xd8")) InputFile(file, "picture").read_at(0, jpeg_reach, head);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  if (head.starts_with("\xff\xd8")) return jpeg_size(head);
  if (head.starts_with("P5")) return pgm_size(head);
  if (head.size() < 24 || !head.starts_with("\x89PNG\r\n\x1a\n")) return std::nullopt;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(head[i]);
    return value;
  };
  const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= longest_side; };
  if (!is_side(number(16)) || !is_side(number(20))) return std::nullopt;
  return ImageSize{static_cast<int>(number(16)), static_cast<int>(number(20))};
}

bool is_whole(const std::string& bytes) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  if (bytes.size() < 4 || byte(0) != 0xff || byte(1) != 0xd8) return true;  // no JPEG
  // Segments with their sizes, up to the pixels: a preview among them has an end of its own.
  for (std::size_t at = 2; at + 4 <= bytes.size() && byte(at) == 0xff;) {
    if (byte(at + 1) == 0xff) {
      ++at;  // fill
      continue;
    }
    const std::size_t next = at + 2 + 256U * byte(at + 2) + byte(at + 3);
    if (byte(at + 1) == 0xda) return bytes.find("\xff\xd9", next) != std::string::npos;
    at = next;
  }
  return false;
}

namespace {

/// As grey of 8 or 16 bits.
cv::Mat decoded(const std::string& bytes) {
  constexpr int as_stored = cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
  const cv::Mat_<unsigned char> raw(1, static_cast<int>(bytes.size()),
                                    reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data())));
  const cv::Mat grey = cv::imdecode(raw, as_stored | cv::IMREAD_ANYDEPTH);
  return grey.depth() == CV_8U || grey.depth() == CV_16U ? grey : cv::imdecode(raw, as_stored);
}

}  // namespace

GrayImage decode_picture(const std::string& bytes) {
  if (!is_whole(bytes)) throw std::runtime_error("it is cut off");
  cv::Mat grey;
  try {
    grey = decoded(bytes);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(error.code == cv::Error::StsNoMem
                                 ? "it asks for more memory than a picture may take"
                                 : "it cannot be decoded");
  }
  if (grey.empty()) throw std::runtime_error("it cannot be decoded");
  require_picture_size(grey.cols, grey.rows);
  if (grey.depth() == CV_16U)
    return narrowed(grey.cols, grey.rows, {grey.ptr<std::uint16_t>(), grey.total()});
  GrayImage image{grey.cols, grey.rows, {}};
  image.pixels.reserve(grey.total());
  for (int row = 0; row < grey.rows; ++row)
    image.pixels.insert(image.pixels.end(), grey.ptr(row), grey.ptr(row) + grey.cols);
  return image;
}

double exif_time(const std::string& bytes) {
  const std::unique_ptr<ExifData, ExifDeleter> data(exif_data_new_from_data(
      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned>(bytes.size())));
  if (!data) return -1.0;
  const auto date = seconds_of_exif(exif_text(*data, EXIF_TAG_DATE_TIME_ORIGINAL));
  if (!date) return -1.0;
  return *date + fraction_of(exif_text(*data, EXIF_TAG_SUB_SEC_TIME_ORIGINAL));
}

}  // namespace clearway
