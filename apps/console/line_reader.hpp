#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

namespace clearway {

struct InputLine {
  std::string text;          ///< without its end; empty when it is too long
  bool is_too_long = false;  ///< it was read to its end and not kept
};

/// Reads a stream line by line as it comes, and holds no more than `most` bytes of one.
class LineReader {
 public:
  LineReader(std::istream& in, std::size_t most) : in_(in), most_(most) {}

  /// The next line; the last one needs no line end. None when the stream is at its end or fails.
  std::optional<InputLine> next();

 private:
  std::istream& in_;
  std::size_t most_;
};

}  // namespace clearway
