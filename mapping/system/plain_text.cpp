#include "mapping/system/plain_text.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>

namespace clearway {
namespace {

constexpr std::size_t longest = 80, longest_path = 255;

/// Bytes of the UTF-8 character at the start of `text`, 0 when there is none; `code` is its number.
std::size_t take_character(std::string_view text, std::uint32_t& code) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t size = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (size == 0 || first > 0xf4 || text.size() < size) return 0;
  code = size == 1 ? first : first & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xc0U) != 0x80U) return 0;
    code = code << 6U | (next & 0x3fU);
  }
  const std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < least[size] || code > 0x10ffff || is_surrogate ? 0 : size;
}

bool is_shown(std::uint32_t code) {
  const bool is_control = code < 0x20 || (code >= 0x7f && code < 0xa0);
  const bool turns = code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
                     (code >= 0x2066 && code <= 0x2069);
  return !is_control && !turns;
}

void append_escaped(std::string& result, std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  for (const char c : bytes) {
    if (c == '\n' || c == '\t' || c == '\r') {
      result += c == '\n' ? "\\n" : c == '\t' ? "\\t" : "\\r";
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    result += {'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
  }
}

/// What comes first in a text, as it is shown.
struct Piece {
  std::string shown;
  std::size_t characters = 0;
};

/// Takes one character, or one byte that is none, off the text.
Piece take_piece(std::string_view& text) {
  std::uint32_t code = 0;
  const std::size_t size = take_character(text, code);
  const std::string_view bytes = text.substr(0, size > 0 ? size : 1);
  text.remove_prefix(bytes.size());
  if (size > 0 && is_shown(code)) return {std::string(bytes), 1};
  Piece piece;
  append_escaped(piece.shown, bytes);
  piece.characters = piece.shown.size();
  return piece;
}

/// Plain text of at most `most` characters as they are shown.
std::string plain_up_to(std::string_view text, std::size_t most) {
  std::string result;
  for (std::size_t characters = 0; !text.empty();) {
    const Piece piece = take_piece(text);
    characters += piece.characters;
    if (characters > most) return result + "…";
    result += piece.shown;
  }
  return result;
}

/// The same, cut at its beginning.
std::string plain_end(std::string_view text, std::size_t most) {
  std::deque<Piece> kept;
  std::size_t characters = 0;
  bool is_cut = false;
  while (!text.empty()) {
    kept.push_back(take_piece(text));
    for (characters += kept.back().characters; characters > most; is_cut = true) {
      characters -= kept.front().characters;
      kept.pop_front();
    }
  }
  std::string result = is_cut ? "…" : "";
  for (const Piece& piece : kept) result += piece.shown;
  return result;
}

}  // namespace

std::string plain(std::string_view text) {
  return plain_up_to(text, std::numeric_limits<std::size_t>::max());
}

std::size_t first_not_utf8(std::string_view text) {
  std::uint32_t code = 0;
  for (std::size_t at = 0, size = 0; at < text.size(); at += size) {
    size = take_character(text.substr(at), code);
    if (size == 0) return at;
  }
  return std::string_view::npos;
}

std::string shortened(std::string_view text) { return plain_up_to(text, longest); }

std::string quote(std::string_view text) { return "'" + shortened(text) + "'"; }

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most_names = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most_names); ++i)
    list += (list.empty() ? "" : ", ") + shortened(names[i]);
  return names.size() <= most_names ? list
                                    : list + " and " + std::to_string(names.size() - most_names) + " more";
}

std::string ended(std::string sentence) {
  const bool is_ended = sentence.ends_with('.') || sentence.ends_with('?');
  return is_ended ? sentence : sentence + ".";
}

std::string quote_path(std::string_view path) { return "'" + plain_end(path, longest_path) + "'"; }

}  // namespace clearway
