#include "datasets/depth_files/tiff_numbers.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace clearway {
namespace {

constexpr unsigned bits_tag = 258, format_tag = 339;  ///< BitsPerSample, SampleFormat
constexpr unsigned unsigned_format = 1, signed_format = 2, short_type = 3;
constexpr std::size_t entry_bytes = 12;

/// Numbers in the order of bytes that a TIFF's first two say.
class TiffBytes {
 public:
  explicit TiffBytes(std::string& bytes) : bytes_(bytes), is_big_(bytes.starts_with("MM")) {}

  bool is_tiff() const {
    return bytes_.size() >= 8 && (is_big_ || bytes_.starts_with("II")) && at(2, 2) == 42;
  }
  std::size_t size() const { return bytes_.size(); }

  unsigned at(std::size_t place, std::size_t count) const {
    unsigned value = 0;
    for (std::size_t i = 0; i < count; ++i)
      value = value << 8U | static_cast<unsigned char>(bytes_[place + (is_big_ ? i : count - 1 - i)]);
    return value;
  }
  std::string text(unsigned value, std::size_t count) const {
    std::string bytes(count, '\0');
    for (std::size_t i = 0; i < count; ++i)
      bytes[is_big_ ? count - 1 - i : i] = static_cast<char>(value >> 8U * i & 0xffU);
    return bytes;
  }
  void put(std::size_t place, unsigned value, std::size_t count) {
    bytes_.replace(place, count, text(value, count));
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string& bytes_;
  bool is_big_;
};

/// The entry of one number of 16 bits with this tag in the directory that begins there.
std::optional<std::size_t> entry_of(const TiffBytes& tiff, std::size_t directory, std::size_t count,
                                    unsigned tag) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = directory + 2 + i * entry_bytes;
    if (tiff.at(entry, 2) == tag && tiff.at(entry + 2, 2) == short_type && tiff.at(entry + 4, 4) == 1)
      return entry;
  }
  return std::nullopt;
}

/// Writes the directory a second time, at the end, with the entry that says that numbers have a sign.
void add_format(TiffBytes& tiff, std::size_t directory, std::size_t count) {
  std::string entries;
  bool is_added = false;
  const std::string added = tiff.text(format_tag, 2) + tiff.text(short_type, 2) + tiff.text(1, 4) +
                            tiff.text(signed_format, 2) + tiff.text(0, 2);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = directory + 2 + i * entry_bytes;
    if (!is_added && tiff.at(entry, 2) > format_tag) {
      entries += added;
      is_added = true;
    }
    entries += tiff.bytes().substr(entry, entry_bytes);
  }
  if (!is_added) entries += added;
  if (tiff.size() % 2 != 0) tiff.bytes() += '\0';
  tiff.put(4, static_cast<unsigned>(tiff.size()), 4);
  tiff.bytes() += tiff.text(static_cast<unsigned>(count) + 1, 2) + entries + tiff.text(0, 4);
}

}  // namespace

std::string with_signed_numbers(std::string bytes) {
  TiffBytes tiff(bytes);
  if (!tiff.is_tiff()) return bytes;
  const std::size_t directory = tiff.at(4, 4);
  if (directory > bytes.size() || bytes.size() - directory < 2) return bytes;
  const std::size_t count = tiff.at(directory, 2);
  if (bytes.size() - directory - 2 < count * entry_bytes) return bytes;
  const auto bits = entry_of(tiff, directory, count, bits_tag),
             format = entry_of(tiff, directory, count, format_tag);
  if (!bits || tiff.at(*bits + 8, 2) != 32) return bytes;
  if (!format)
    add_format(tiff, directory, count);
  else if (tiff.at(*format + 8, 2) == unsigned_format)
    tiff.put(*format + 8, signed_format, 2);
  return bytes;
}

}  // namespace clearway
