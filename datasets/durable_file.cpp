#include "datasets/durable_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace clearway {

DurableFile::DurableFile(const std::filesystem::path& file) : file_(file), part_(file.string() + ".part") {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
    throw std::runtime_error("file '" + file.string() + "' cannot be written: it is not a regular file.");
  }
  descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail();
}

DurableFile::~DurableFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(part_.c_str());
}

void DurableFile::fail() const {
  throw std::runtime_error("file '" + file_.string() + "' cannot be written: " + std::strerror(errno) + ".");
}

void DurableFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail();
    bytes.remove_prefix(static_cast<size_t>(done));
  }
}

void DurableFile::finish() {
  if (fsync(descriptor_) != 0) fail();
  if (rename(part_.c_str(), file_.c_str()) != 0) fail();
  close(descriptor_);
  descriptor_ = -1;
  // The name itself must survive a power cut, too.
  const auto folder = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
  const int folder_descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_descriptor >= 0) {
    fsync(folder_descriptor);
    close(folder_descriptor);
  }
}

}  // namespace clearway
