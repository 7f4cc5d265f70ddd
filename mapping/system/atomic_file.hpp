#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "mapping/system/file_descriptor.hpp"
#include "mapping/system/interruption.hpp"

namespace clearway {

/// Refuses early what `save_file` would refuse late: a folder that is not there or not writable, or a name
/// that something else than a regular file has.
/// @throws std::runtime_error naming `file` and the reason.
void require_writable(const std::filesystem::path& file);

/// A file that appears under its name whole or not at all. It is written beside its place under a name that
/// nobody can guess (see temporary_name.hpp), brought to the disk and renamed by `finish`. Without `finish`,
/// after an error and after a signal the temporary file goes and an older file stays as it was; what a killed
/// process left goes with the next file written to that folder. A link is followed: what it points to is
/// replaced. An older file's permissions are kept.
class AtomicFile {
 public:
  /// @throws std::runtime_error naming the file and why it cannot be written, as do the others.
  explicit AtomicFile(const std::filesystem::path& file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void append(std::string_view bytes);
  /// Nothing may be appended afterwards.
  void finish();

 private:
  void open_temporary();
  void remove();

  std::filesystem::path file_, target_, temporary_;
  FileDescriptor descriptor_;
  UnfinishedWork unfinished_;
};

/// Makes the folders that `file` lies in, where they lack. Once a signal has come nothing is made: what
/// another thread removed then is not made anew.
/// @throws std::filesystem::filesystem_error
void make_folder_of(const std::filesystem::path& file);

/// Replaces `file` by this content as a whole or not at all: an AtomicFile from begin to end.
/// @throws std::runtime_error naming `file` and the reason.
void save_file(const std::filesystem::path& file, std::string_view content);

}  // namespace clearway
