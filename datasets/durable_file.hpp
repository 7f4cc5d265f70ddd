#pragma once

#include <filesystem>
#include <string_view>

namespace clearway {

/// A file that appears under its name whole or not at all: it is written as `<file>.part`, synced to the disk
/// and renamed by `finish`. Without `finish` the part is removed and an older file stays as it was.
class DurableFile {
 public:
  /// @throws std::runtime_error naming the file when it cannot be written.
  explicit DurableFile(const std::filesystem::path& file);
  ~DurableFile();
  DurableFile(const DurableFile&) = delete;
  DurableFile& operator=(const DurableFile&) = delete;

  void append(std::string_view bytes);
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_, part_;
  int descriptor_;
};

}  // namespace clearway
