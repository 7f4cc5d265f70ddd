#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Where an array lies among the page's arrays: the page reads `count` little-endian elements of `type` from
/// byte `offset`.
struct ArrayPlace {
  std::string type;  ///< "f32", "u32", "u16" or "u8"
  std::size_t offset = 0, count = 0;
};

/// The binary arrays of a report page, one after the other, each aligned to four bytes.
class PageArrays {
 public:
  ArrayPlace add(std::span<const float> values);
  ArrayPlace add(std::span<const std::uint32_t> values);
  ArrayPlace add(std::span<const std::uint16_t> values);
  ArrayPlace add(std::string_view bytes);

  /// All arrays as gzip in base64; equal arrays give equal text.
  /// @throws std::runtime_error when zlib fails (out of memory).
  std::string encode() const;

 private:
  ArrayPlace append(const char* type, const void* data, std::size_t count, std::size_t element_size);
  std::vector<unsigned char> bytes_;
};

}  // namespace clearway
