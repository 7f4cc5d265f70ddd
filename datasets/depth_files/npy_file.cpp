#include "datasets/depth_files/npy_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::string_view magic("\x93NUMPY", 6);

/// What the head of an array says.
struct ArrayHead {
  std::string type;  ///< such as "<f4"
  bool is_fortran = false;
  std::vector<std::int64_t> shape;
  std::size_t data_at = 0;
};

/// The text of the dictionary in the head, and where the numbers begin.
std::pair<std::string_view, std::size_t> dictionary_of(const std::string& bytes) {
  const auto byte = [&](std::size_t at) {
    return at < bytes.size() ? std::size_t{static_cast<unsigned char>(bytes[at])} : 0U;
  };
  const bool is_first = byte(6) == 1;
  const std::size_t begin = is_first ? 10 : 12;
  std::size_t size = byte(8) | byte(9) << 8U;
  if (!is_first) size |= byte(10) << 16U | byte(11) << 24U;
  if (begin > bytes.size() || size > bytes.size() - begin) throw std::runtime_error("it is cut off");
  return {std::string_view(bytes).substr(begin, size), begin + size};
}

/// What follows `'key':`, without blanks before it.
std::string_view value_of(std::string_view dictionary, std::string_view key) {
  std::size_t at = std::string_view::npos;
  for (const char mark : {'\'', '"'}) {
    const std::string quoted = mark + std::string(key) + mark;
    if (at == std::string_view::npos) at = dictionary.find(quoted);
  }
  const std::size_t colon = dictionary.find(':', at);
  if (at == std::string_view::npos || colon == std::string_view::npos)
    throw std::runtime_error("its head names no '" + std::string(key) + "'");
  const std::size_t from = dictionary.find_first_not_of(' ', colon + 1);
  return from == std::string_view::npos ? std::string_view() : dictionary.substr(from);
}

std::vector<std::int64_t> numbers_in(std::string_view tuple) {
  const std::size_t end = tuple.find(')');
  if (!tuple.starts_with("(") || end == std::string_view::npos)
    throw std::runtime_error("its head holds no shape");
  std::vector<std::int64_t> numbers;
  for (std::size_t at = 1; at < end;) {
    if (tuple[at] == ' ' || tuple[at] == ',') {
      ++at;
      continue;
    }
    std::int64_t number = 0;
    const auto read = std::from_chars(tuple.data() + at, tuple.data() + end, number);
    if (read.ec != std::errc() || number < 0) throw std::runtime_error("its head holds no shape");
    numbers.push_back(number);
    at = static_cast<std::size_t>(read.ptr - tuple.data());
  }
  return numbers;
}

ArrayHead head_of(const std::string& bytes) {
  const auto [dictionary, data_at] = dictionary_of(bytes);
  ArrayHead head;
  head.data_at = data_at;
  const std::string_view type = value_of(dictionary, "descr");
  if (type.empty() || (type[0] != '\'' && type[0] != '"'))
    throw std::runtime_error("it holds records: expected one number of depth in each pixel");
  head.type = type.substr(1, type.find(type[0], 1) - 1);
  head.is_fortran = value_of(dictionary, "fortran_order").starts_with("True");
  head.shape = numbers_in(value_of(dictionary, "shape"));
  return head;
}

/// "4 x 3" of an array of four rows and three columns.
std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t side : shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  return text.empty() ? "no" : text;
}

/// Rows and columns.
std::pair<std::int64_t, std::int64_t> sides_of(const ArrayHead& head) {
  std::vector<std::int64_t> sides = head.shape;
  if (sides.size() == 3 && sides.back() == 1)
    sides.pop_back();
  else if (sides.size() == 3 && sides.front() == 1)
    sides.erase(sides.begin());
  if (sides.size() != 2)
    throw std::runtime_error("it is an array of " + shape_text(head.shape) +
                             " entries: expected rows and columns");
  require_picture_size(sides[1], sides[0]);
  return {sides[0], sides[1]};
}

template <typename Number>
double number_at(const char* bytes, bool is_swapped) {
  std::array<char, sizeof(Number)> own;
  std::memcpy(own.data(), bytes, own.size());
  if (is_swapped) std::reverse(own.begin(), own.end());
  Number number;
  std::memcpy(&number, own.data(), own.size());
  return static_cast<double>(number);
}

double half_at(const char* bytes, bool is_swapped) {
  std::array<char, 2> own{bytes[0], bytes[1]};
  if (is_swapped) std::swap(own[0], own[1]);
  cv::float16_t half;
  std::memcpy(&half, own.data(), own.size());
  return double{static_cast<float>(half)};
}

using Reading = double (*)(const char*, bool);

bool is_of_another_order(const ArrayHead& head) {
  return (head.type[0] == '>') == (std::endian::native == std::endian::little);
}

/// How one number of this type is read, and how many bytes it has.
std::pair<Reading, std::size_t> reading_of(const std::string& type) {
  const std::string kind = type.size() > 1 ? type.substr(1) : "";
  if (kind == "u1" || kind == "i1" || kind == "b1")
    throw std::runtime_error("its numbers have 8 bits, as of a picture to look at: expected 16 bits or more");
  if (kind == "u2") return {number_at<std::uint16_t>, 2};
  if (kind == "u4") return {number_at<std::uint32_t>, 4};
  if (kind == "u8") return {number_at<std::uint64_t>, 8};
  if (kind == "i2") return {number_at<std::int16_t>, 2};
  if (kind == "i4") return {number_at<std::int32_t>, 4};
  if (kind == "i8") return {number_at<std::int64_t>, 8};
  if (kind == "f2") return {half_at, 2};
  if (kind == "f4") return {number_at<float>, 4};
  if (kind == "f8") return {number_at<double>, 8};
  throw std::runtime_error("its numbers are of the type " + quote(type) +
                           ", expected whole or real ones of at most 64 bits");
}

std::size_t count_of(const std::vector<std::int64_t>& shape, std::size_t most) {
  std::size_t count = 1;
  for (const std::int64_t side : shape) {
    if (side > 0 && count > most / static_cast<std::size_t>(side))
      throw std::runtime_error("it is an array of " + shape_text(shape) + " entries, expected at most " +
                               std::to_string(most));
    count *= static_cast<std::size_t>(side);
  }
  return count;
}

/// Where the entry that is `at` in C's order stands in Fortran's, whose first index runs fastest.
std::size_t place_in_fortran(std::size_t at, const std::vector<std::int64_t>& shape, std::size_t count) {
  std::size_t place = 0, stride = count;
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    const auto side = static_cast<std::size_t>(shape[axis]);
    stride /= side;
    place += at % side * stride;
    at /= side;
  }
  return place;
}

}  // namespace

bool is_npy(const std::string& bytes) { return std::string_view(bytes).starts_with(magic); }

DepthPicture decode_npy(const std::string& bytes) {
  const ArrayHead head = head_of(bytes);
  const auto [rows, columns] = sides_of(head);
  const auto [read, size] = reading_of(head.type);
  if (bytes.size() - head.data_at < static_cast<std::size_t>(rows * columns) * size)
    throw std::runtime_error("it is cut off");
  DepthPicture picture{{static_cast<int>(columns), static_cast<int>(rows)}, {}, head.type[1] == 'f'};
  picture.values.reserve(static_cast<std::size_t>(rows * columns));
  const bool is_swapped = is_of_another_order(head);
  for (std::int64_t row = 0; row < rows; ++row)
    for (std::int64_t column = 0; column < columns; ++column) {
      const std::int64_t at = head.is_fortran ? column * rows + row : row * columns + column;
      picture.values.push_back(
          static_cast<float>(read(&bytes[head.data_at + static_cast<std::size_t>(at) * size], is_swapped)));
    }
  return picture;
}

NpyNumbers decode_npy_numbers(const std::string& bytes, std::size_t most) {
  const ArrayHead head = head_of(bytes);
  const auto [read, size] = reading_of(head.type);
  NpyNumbers numbers{head.shape, shape_text(head.shape), head.type.substr(1), {}};
  const std::size_t count = count_of(head.shape, most);
  if ((bytes.size() - head.data_at) / size < count) throw std::runtime_error("it is cut off");
  numbers.values.reserve(count);
  const bool is_swapped = is_of_another_order(head);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = head.is_fortran ? place_in_fortran(i, head.shape, count) : i;
    numbers.values.push_back(read(&bytes[head.data_at + at * size], is_swapped));
  }
  return numbers;
}

}  // namespace clearway
