#include "mapping/system/file_descriptor.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "mapping/system/temporary_name.hpp"

namespace clearway {

FileDescriptor::~FileDescriptor() {
  if (is_open()) ::close(number_);
}

FileDescriptor open_to_read(const std::filesystem::path& path) {
  return FileDescriptor(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
}

bool is_same_file(const FileDescriptor& descriptor, const std::filesystem::path& path) {
  struct stat opened {
  }, named{};
  return ::fstat(descriptor.number(), &opened) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

bool lock(const FileDescriptor& descriptor, bool required) {
  while (::flock(descriptor.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno != EWOULDBLOCK && !required;
  }
  return true;
}

void write_all(const FileDescriptor& descriptor, std::string_view bytes, const std::filesystem::path& file) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(file);
    if (written == 0) fail_to_write(file, "the disk is full");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void sync_folder(const std::filesystem::path& folder, const std::filesystem::path& what) {
  const FileDescriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.is_open()) return;  // a folder that may be written and not read
  if (::fsync(opened.number()) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EBADF) return;
  fail_to_write(what);
}

void fail_to_write(const std::filesystem::path& file, const std::string& reason) {
  const std::filesystem::path folder = lasting_folder(file);
  if (folder.empty()) throw std::runtime_error("cannot write '" + file.string() + "': " + reason);
  std::error_code error;
  throw std::runtime_error(
      "cannot write '" + file.filename().string() + "' for '" + folder.string() + "', which " +
      (std::filesystem::exists(folder, error) ? "is as it was" : "is not there") + ": " + reason);
}

void fail_to_write(const std::filesystem::path& file) { fail_to_write(file, std::strerror(errno)); }

}  // namespace clearway
