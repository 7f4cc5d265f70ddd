#include "apps/console/plain_stream.hpp"

#include <algorithm>

#include "mapping/system/plain_text.hpp"

namespace clearway {

std::string plain_lines(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\n\t"), text.size());
    result += plain(text.substr(0, end));
    if (end < text.size()) result += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

PlainBuffer::int_type PlainBuffer::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return 0;
  const char letter = traits_type::to_char_type(c);
  return xsputn(&letter, 1) == 1 ? c : traits_type::eof();
}

std::streamsize PlainBuffer::xsputn(const char* text, std::streamsize size) {
  waiting_.append(text, static_cast<std::size_t>(size));
  const std::size_t last = waiting_.rfind('\n');  // a character never comes in two parts across it
  return last == std::string::npos || send(last + 1) ? size : 0;
}

int PlainBuffer::sync() { return send(waiting_.size()) && target_.flush() ? 0 : -1; }

bool PlainBuffer::send(std::size_t count) {
  target_ << plain_lines(std::string_view(waiting_).substr(0, count));
  waiting_.erase(0, count);
  return target_.good();
}

}  // namespace clearway
