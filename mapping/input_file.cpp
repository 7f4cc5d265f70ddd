#include "mapping/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "mapping/plain_text.hpp"

namespace clearway {
namespace {

/// A regular file, open for reading.
class OpenInput {
 public:
  OpenInput(const std::filesystem::path& file, const std::string& what)
      : name_(what + " '" + plain(file.string()) + "'") {
    // A pipe without a writer would keep a plain open() waiting; which file it is, is only certain once open.
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor_ < 0) refuse(errno == ENXIO ? "it is not a regular file" : std::strerror(errno));
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) refuse(std::strerror(errno));
    if (!S_ISREG(status.st_mode)) refuse(kind(status.st_mode) + ", expected a regular file");
    size_ = static_cast<std::size_t>(status.st_size);
  }
  ~OpenInput() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenInput(const OpenInput&) = delete;
  OpenInput& operator=(const OpenInput&) = delete;

  std::string read(std::size_t largest) {
    if (size_ > largest) refuse_size(largest);
    std::string bytes(size_ + 1, '\0');  // one more: files of /proc say that they have no size
    std::size_t done = 0;
    for (;;) {
      const ssize_t got = ::read(descriptor_, bytes.data() + done, bytes.size() - done);
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

 private:
  static std::string kind(mode_t mode) {
    if (S_ISDIR(mode)) return "it is a folder";
    if (S_ISFIFO(mode)) return "it is a pipe";
    if (S_ISSOCK(mode)) return "it is a socket";
    return "it is a device";
  }
  [[noreturn]] void refuse(const std::string& why) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    throw std::invalid_argument(name_ + " cannot be read: " + why);
  }
  [[noreturn]] void refuse_size(std::size_t largest) {
    const bool megabytes = largest >= 1U << 20U;
    refuse("it has more than " + std::to_string(largest >> (megabytes ? 20U : 10U)) +
           (megabytes ? " MB" : " kB") + ", the most that is read");
  }

  std::string name_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

}  // namespace

std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest) {
  return OpenInput(file, what).read(largest);
}

void require_input(const std::filesystem::path& file, const std::string& what) {
  static_cast<void>(OpenInput(file, what));
}

}  // namespace clearway
