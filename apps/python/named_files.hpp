#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace clearway {

/// A file that the caller named and that cannot be opened: an OSError, of the class that Python has for the
/// reason (FileNotFoundError, PermissionError, IsADirectoryError).
class UnreadableFile : public std::runtime_error {
 public:
  /// @param reason errno
  UnreadableFile(const std::string& sentence, int reason) : std::runtime_error(sentence), reason_(reason) {}
  int reason() const { return reason_; }

 private:
  int reason_;
};

/// errno of opening a regular file for reading; 0: it can be opened.
int reason_not_to_open(const std::filesystem::path& file);

/// What `read` makes of a file that the caller named. @throws UnreadableFile with the refusal's sentence,
/// where the file cannot be opened; else what `read` throws
template <typename Read>
auto read_named(const std::filesystem::path& file, const Read& read) {
  try {
    return read();
  } catch (const std::invalid_argument& refused) {
    if (const int reason = reason_not_to_open(file)) throw UnreadableFile(refused.what(), reason);
    throw;
  }
}

}  // namespace clearway
