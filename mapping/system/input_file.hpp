#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {

/// A regular file, open for reading. Anything else (a folder, pipe, socket or device, which could keep the
/// program waiting for ever) is refused without waiting for it.
class InputFile {
 public:
  /// @param what it should be, as errors call it: "map file".
  /// @throws std::invalid_argument "<what> '<file>' cannot be read: <why>", as does `read`.
  InputFile(const std::filesystem::path& file, const std::string& what);

  /// All of it, unless it has more than `largest` bytes. To be called once.
  std::string read(std::size_t largest) const;

  /// Bytes `from` to `from + count` into `piece`; fewer at the end of the file. As often as one likes.
  void read_at(std::size_t from, std::size_t count, std::string& piece) const;

  int descriptor() const { return descriptor_.number(); }
  std::size_t size() const { return size_; }

 private:
  [[noreturn]] void refuse(const std::string& why) const;
  [[noreturn]] void refuse_size(std::size_t largest) const;

  std::string name_;
  FileDescriptor descriptor_;
  std::size_t size_ = 0;
};

/// All bytes of a regular file of at most `largest` bytes. @throws std::invalid_argument as InputFile does.
std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest);

/// The end of a file's name that says what it holds, in small letters: ".pcd" of scan.PCD, "" without one.
std::string extension_of(const std::filesystem::path& file);

/// Refuses what read_input would refuse but for its size, for files that a library opens by their name.
void require_input(const std::filesystem::path& file, const std::string& what);

}  // namespace clearway
