// A library that stands before libc and lets one of a process's calls to the disk fail.
#include "tests/apps/faulty_disk/faulty_disk.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace {

std::atomic<long> counted = 0, chosen = 0;
std::atomic<int> reason = 0;

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// Counts a call; true when it shall fail, errno set.
bool fails() {
  if (++counted != chosen) return false;
  if (reason == 0) ::kill(::getpid(), SIGKILL);
  errno = reason;
  return true;
}

bool is_file(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

bool writes(int flags) { return (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0; }

}  // namespace

namespace clearway {
void fail_disk_call(long number, int error) {
  counted = 0;
  reason = error;
  chosen = number;
}
long disk_calls() { return counted; }
}  // namespace clearway

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (writes(flags) && fails()) return -1;
  return real<int(const char*, int, ...)>("open")(path, flags, mode);
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  if (is_file(descriptor) && fails()) return -1;
  return real<ssize_t(int, const void*, std::size_t)>("write")(descriptor, bytes, size);
}

int ftruncate(int descriptor, off_t size) noexcept {
  return fails() ? -1 : real<int(int, off_t)>("ftruncate")(descriptor, size);
}

int fsync(int descriptor) { return fails() ? -1 : real<int(int)>("fsync")(descriptor); }

int fdatasync(int descriptor) { return fails() ? -1 : real<int(int)>("fdatasync")(descriptor); }

int rename(const char* from, const char* to) noexcept {
  return fails() ? -1 : real<int(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  if (fails()) return -1;
  return real<int(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from, to_folder,
                                                                              to, flags);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return fails() ? -1 : real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  if (fails()) return -1;
  return real<int(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder, to,
                                                                      flags);
}

}  // extern "C"
