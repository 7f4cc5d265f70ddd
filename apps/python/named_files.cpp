#include "apps/python/named_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {

int reason_not_to_open(const std::filesystem::path& file) {
  // A pipe without a writer would keep a plain open() waiting.
  const FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (!opened.is_open() || ::fstat(opened.number(), &status) != 0) return errno;
  if (S_ISDIR(status.st_mode)) return EISDIR;
  return S_ISREG(status.st_mode) ? 0 : EINVAL;
}

}  // namespace clearway
