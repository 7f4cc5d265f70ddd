#include "mapping/save_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

namespace clearway {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw std::runtime_error("cannot write '" + file.string() + "': " + reason);
}

/// An open file descriptor, closed at the end of its scope.
struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number;
};

void sync_to_disk(const std::filesystem::path& file, const std::filesystem::path& what, int flags) {
  const Descriptor opened(::open(what.c_str(), flags | O_CLOEXEC));
  if (opened.number < 0 || ::fsync(opened.number) != 0) fail(file, std::strerror(errno));
}

/// The folder entry must reach the disk too. Some file systems cannot sync a folder; the new file itself is
/// whole by then, so that is no failure.
void sync_folder(const std::filesystem::path& folder) {
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.number >= 0) ::fsync(opened.number);
}

void write_all(const std::filesystem::path& temporary, std::string_view content) {
  const Descriptor out(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (out.number < 0) throw std::runtime_error(std::strerror(errno));
  while (!content.empty()) {
    const ssize_t written = ::write(out.number, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw std::runtime_error(written < 0 ? std::strerror(errno) : "the disk is full");
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// The file to replace: what a link points to, not the link.
std::filesystem::path target_of(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) ? std::filesystem::canonical(file, error) : file;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace

void require_writable(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    fail(file, "it exists and is not a regular file");
  }
  if (std::filesystem::exists(status) && ::access(file.c_str(), W_OK) != 0) fail(file, std::strerror(errno));
  if (!file.has_filename()) fail(file, "expected the name of a file");
  if (::access(folder_of(target_of(file)).c_str(), W_OK | X_OK) != 0) fail(file, std::strerror(errno));
}

void save_file(const std::filesystem::path& file,
               const std::function<void(const std::filesystem::path& temporary)>& write) {
  require_writable(file);
  std::error_code error;
  const auto target = target_of(file);
  const auto folder = folder_of(target);
  const auto temporary =
      folder / ("." + target.filename().string() + "." + std::to_string(::getpid()) + ".part");
  try {
    write(temporary);
    sync_to_disk(file, temporary, O_RDONLY);
    if (::rename(temporary.c_str(), target.c_str()) != 0) fail(file, std::strerror(errno));
  } catch (...) {
    std::filesystem::remove(temporary, error);
    throw;
  }
  sync_folder(folder);
}

void save_file(const std::filesystem::path& file, std::string_view content) {
  save_file(file, [&](const std::filesystem::path& temporary) {
    try {
      write_all(temporary, content);
    } catch (const std::runtime_error& reason) {
      fail(file, reason.what());
    }
  });
}

}  // namespace clearway
