#include "mapping/system/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::string kind(mode_t mode) {
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe";
  if (S_ISSOCK(mode)) return "it is a socket";
  return "it is a device";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file, const std::string& what)
    : name_(what + " " + quote_path(file.string())),
      // A pipe without a writer would keep a plain open() waiting; which file it is, is only certain once
      // open.
      descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
  if (!descriptor_.is_open()) refuse(errno == ENXIO ? "it is not a regular file" : std::strerror(errno));
  struct stat status {};
  if (::fstat(descriptor(), &status) != 0) refuse(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) refuse(kind(status.st_mode) + ", expected a regular file");
  size_ = static_cast<std::size_t>(status.st_size);
}

std::string InputFile::read(std::size_t largest) const {
  if (size_ > largest) refuse_size(largest);
  std::string bytes(size_ + 1, '\0');  // one more: files of /proc say that they have no size
  std::size_t done = 0;
  for (;;) {
    const ssize_t got = ::read(descriptor(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
    if (done > largest) refuse_size(largest);
    if (done == bytes.size()) bytes.resize(2 * bytes.size());
  }
  if (done < size_) refuse("it became shorter while it was read");
  bytes.resize(done);
  return bytes;
}

void InputFile::read_at(std::size_t from, std::size_t count, std::string& piece) const {
  piece.resize(count);
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got =
        ::pread(descriptor(), piece.data() + done, count - done, static_cast<off_t>(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  piece.resize(done);
}

void InputFile::refuse(const std::string& why) const {
  throw std::invalid_argument(name_ + " cannot be read: " + why);
}

void InputFile::refuse_size(std::size_t largest) const {
  const bool megabytes = largest >= 1U << 20U;
  refuse("it has more than " + std::to_string(largest >> (megabytes ? 20U : 10U)) +
         (megabytes ? " MB" : " kB") + ", the most that is read");
}

std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest) {
  return InputFile(file, what).read(largest);
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

void require_input(const std::filesystem::path& file, const std::string& what) {
  static_cast<void>(InputFile(file, what));
}

}  // namespace clearway
