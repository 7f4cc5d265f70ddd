#include "apps/console/line_reader.hpp"

#include <istream>

namespace clearway {

std::optional<InputLine> LineReader::next() {
  using Traits = std::istream::traits_type;
  std::streambuf* const buffer = in_.rdbuf();
  if (buffer == nullptr) return std::nullopt;
  InputLine line;
  std::size_t size = 0;
  for (;; ++size) {
    const Traits::int_type c = buffer->sbumpc();
    if (Traits::eq_int_type(c, Traits::eof())) {
      if (size == 0) return std::nullopt;
      break;
    }
    const char letter = Traits::to_char_type(c);
    if (letter == '\n') break;
    if (size < most_) line.text += letter;
  }
  line.is_too_long = size > most_;
  if (line.is_too_long) line.text = {};
  return line;
}

}  // namespace clearway
