#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace clearway {

/// An open file or folder, closed at the end of its scope.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor();

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

/// Opens what is there to look at or to lock, links not followed.
FileDescriptor open_to_read(const std::filesystem::path& path);

/// Whether `path` still is what `descriptor` has open.
bool is_same_file(const FileDescriptor& descriptor, const std::filesystem::path& path);

/// Takes the lock (flock) of what is open: false when another process has it. True as well where the file
/// system knows no locks and `required` is false.
bool lock(const FileDescriptor& descriptor, bool required);

/// Writes all of it.
/// @throws std::runtime_error naming `file` and the reason.
void write_all(const FileDescriptor& descriptor, std::string_view bytes, const std::filesystem::path& file);

/// Brings a folder's entries to the disk. Some file systems cannot sync a folder: that is no failure.
/// @throws std::runtime_error naming `what` and the reason, such as a disk that reports an error.
void sync_folder(const std::filesystem::path& folder, const std::filesystem::path& what);

/// "cannot write 'FILE': REASON". A temporary folder that `file` lies in is told as what it was to become.
[[noreturn]] void fail_to_write(const std::filesystem::path& file, const std::string& reason);
/// The same with errno's reason.
[[noreturn]] void fail_to_write(const std::filesystem::path& file);

}  // namespace clearway
