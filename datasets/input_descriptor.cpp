#include "datasets/input_descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace clearway {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw std::invalid_argument(name + " cannot be read: " + why + ".");
}

std::string kind(mode_t mode) {
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe";
  if (S_ISSOCK(mode)) return "it is a socket";
  return "it is a device";
}

}  // namespace

InputDescriptor::InputDescriptor(const std::filesystem::path& file, const std::string& name)
    // A pipe without a writer would keep a plain open() waiting; which file it is, is only certain once open.
    : descriptor_(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
  if (descriptor_ < 0) refuse(name, errno == ENXIO ? "it is not a regular file" : std::strerror(errno));
  struct stat status {};
  const bool known = fstat(descriptor_, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    close(descriptor_);
    refuse(name, (known ? kind(status.st_mode) : "its kind is not known") + ", expected a regular file");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputDescriptor::~InputDescriptor() { close(descriptor_); }

std::string read_text_file(const std::filesystem::path& file, const std::string& name, std::size_t largest) {
  const InputDescriptor input(file, name);
  const auto refuse_size = [&] {
    refuse(name, "it has more than " + std::to_string(largest >> 20U) + " MB, the most that is read");
  };
  if (input.size() > largest) refuse_size();
  std::string text(input.size() + 1, '\0');  // one more: files of /proc say that they have no size
  for (size_t done = 0;;) {
    const ssize_t got = ::read(input.number(), text.data() + done, text.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(name, std::strerror(errno));
    done += static_cast<size_t>(got);
    if (done > largest) refuse_size();
    if (got == 0) {
      text.resize(done);
      return text;
    }
    if (done == text.size()) text.resize(2 * done);
  }
}

}  // namespace clearway
