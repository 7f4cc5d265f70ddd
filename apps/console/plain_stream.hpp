#pragma once

#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace clearway {

/// The text with control characters escaped (see plain()) but for line ends and tabs.
std::string plain_lines(std::string_view text);

/// Makes a stream that no name or label out of a file can use to command a terminal: what passes is as
/// plain_lines has it. Whole lines leave at once, the rest when it is flushed.
class PlainBuffer final : public std::streambuf {
 public:
  explicit PlainBuffer(std::ostream& target) : target_(target) {}
  ~PlainBuffer() override { sync(); }

 private:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;
  bool send(std::size_t count);

  std::ostream& target_;
  std::string waiting_;
};

}  // namespace clearway
