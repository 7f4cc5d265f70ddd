#include "mapping/system/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>

#include "mapping/system/temporary_name.hpp"

namespace clearway {
namespace {

/// The file to replace: what a link points to, not the link.
std::filesystem::path target_of(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) ? std::filesystem::canonical(file, error) : file;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// The first file of this process in a folder removes what others left there.
void remove_abandoned_once(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> looked_at;
  std::error_code error;
  const std::lock_guard held(mutex);
  if (looked_at.insert(std::filesystem::absolute(folder, error)).second) remove_abandoned(folder);
}

/// Permissions and, where that is allowed, the owner of the file that is replaced.
void take_over_permissions(int descriptor, const std::filesystem::path& older) {
  struct stat status {};
  if (::stat(older.c_str(), &status) != 0) return;
  [[maybe_unused]] const int owner = ::fchown(descriptor, status.st_uid, status.st_gid);
  ::fchmod(descriptor, status.st_mode & 0777U);
}

}  // namespace

void require_writable(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    fail_to_write(file, "it exists and is not a regular file");
  }
  if (std::filesystem::exists(status) && ::access(file.c_str(), W_OK) != 0) fail_to_write(file);
  if (!file.has_filename()) fail_to_write(file, "expected the name of a file");
  if (::access(folder_of(target_of(file)).c_str(), W_OK | X_OK) != 0) fail_to_write(file);
}

AtomicFile::AtomicFile(const std::filesystem::path& file)
    : file_(file), unfinished_([this] {
        remove();
        return std::string();
      }) {
  require_writable(file_);
  target_ = target_of(file_);
  remove_abandoned_once(folder_of(target_));
  open_temporary();
  take_over_permissions(descriptor_.number(), target_);
}

AtomicFile::~AtomicFile() { remove(); }

void AtomicFile::open_temporary() {
  for (int attempt = 0; attempt < 100; ++attempt) {
    const auto held = uninterrupted();
    temporary_ = temporary_name(target_);
    descriptor_ = FileDescriptor(
        ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!descriptor_.is_open()) {
      const int reason = errno;
      temporary_.clear();
      if (reason == EEXIST) continue;
      fail_to_write(file_, std::strerror(reason));
    }
    // Between the two calls another process may have taken it for abandoned.
    if (lock(descriptor_, false) && is_same_file(descriptor_, temporary_)) return;
    remove();
  }
  fail_to_write(file_, "no temporary file can be made beside it");
}

void AtomicFile::remove() {
  const auto held = uninterrupted();
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::append(std::string_view bytes) { write_all(descriptor_, bytes, file_); }

void AtomicFile::finish() {
  if (::fsync(descriptor_.number()) != 0) fail_to_write(file_);
  {
    const auto held = uninterrupted();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail_to_write(file_);
    temporary_.clear();
    written_file(file_);
  }
  sync_folder(folder_of(target_), file_);
}

void make_folder_of(const std::filesystem::path& file) {
  const auto held = uninterrupted();
  std::filesystem::create_directories(file.parent_path());
}

void save_file(const std::filesystem::path& file, std::string_view content) {
  AtomicFile out(file);
  out.append(content);
  out.finish();
}

}  // namespace clearway
