#include "datasets/shown.hpp"

#include <cstddef>

namespace clearway {
namespace {

/// Bytes of the printable UTF-8 character that `text` begins with; 0 when it begins with none.
std::size_t printable(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) >= 0x20 && byte(0) < 0x7f) return 1;
  if (byte(0) < 0xc2 || byte(0) > 0xf4) return 0;
  const std::size_t size = byte(0) < 0xe0 ? 2 : byte(0) < 0xf0 ? 3 : 4;
  if (text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xc0U) != 0x80U) return 0;
  if (byte(0) == 0xc2 && byte(1) < 0xa0) return 0;  // controls of eight bits
  if (byte(0) == 0xe0 && byte(1) < 0xa0) return 0;  // longer than need be
  if (byte(0) == 0xf0 && byte(1) < 0x90) return 0;
  if (byte(0) == 0xed && byte(1) > 0x9f) return 0;  // surrogates
  if (byte(0) == 0xf4 && byte(1) > 0x8f) return 0;
  const bool turns =
      byte(0) == 0xe2 &&
      ((byte(1) == 0x80 && (byte(2) == 0x8e || byte(2) == 0x8f || (byte(2) >= 0xa8 && byte(2) <= 0xae))) ||
       (byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9));
  return turns ? 0 : size;  // marks that turn the direction of writing
}

std::string cut(std::string_view text, std::size_t most) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  for (std::size_t characters = 0; !text.empty();) {
    const std::size_t size = printable(text);
    characters += size > 0 ? 1 : 4;
    if (characters > most) return result + "…";
    if (size > 0) {
      result += text.substr(0, size);
    } else {
      const auto byte = static_cast<unsigned char>(text[0]);
      result += {'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
    }
    text.remove_prefix(size > 0 ? size : 1);
  }
  return result;
}

}  // namespace

std::string shown(std::string_view text) { return "'" + cut(text, 80) + "'"; }

std::string shown_path(std::string_view path) { return "'" + cut(path, 255) + "'"; }

bool is_plain(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = printable(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

}  // namespace clearway
