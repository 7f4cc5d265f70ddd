#include "mapping/system/temporary_name.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = ".clearway-", aside = "aside-";
constexpr std::size_t digits = 16;
constexpr std::size_t longest_kept = 200;  // of the target's name: file systems end at 255 bytes

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) == sizeof number) return number;
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

/// What a temporary was made for; no target for any other name.
struct Purpose {
  std::string target;
  bool was_moved_aside = false;
};

Purpose purpose_of(const std::string& name) {
  const std::size_t end = name.rfind(mark);
  if (end == std::string::npos || end < 2 || name[0] != '.') return {};
  std::string_view rest = std::string_view(name).substr(end + mark.size());
  const bool moved = rest.starts_with(aside);
  if (moved) rest.remove_prefix(aside.size());
  if (rest.size() != digits || rest.find_first_not_of("0123456789abcdef") != rest.npos) return {};
  return {name.substr(1, end - 1), moved};
}

void remove_if_abandoned(const fs::path& path, const Purpose& purpose) {
  const FileDescriptor opened = open_to_read(path);
  struct stat status {};
  if (!opened.is_open() || ::fstat(opened.number(), &status) != 0 || status.st_uid != ::geteuid()) return;
  if (!lock(opened, true) || !is_same_file(opened, path)) return;
  if (purpose.was_moved_aside) {
    const fs::path target = path.parent_path() / purpose.target;
    if (::renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, target.c_str(), RENAME_NOREPLACE) == 0) return;
    std::error_code error;
    if (!fs::exists(target, error) && ::rename(path.c_str(), target.c_str()) == 0) return;
  }
  if (S_ISREG(status.st_mode)) ::unlink(path.c_str());
  if (S_ISDIR(status.st_mode)) remove_tree(path);
}

fs::path named_beside(const fs::path& target, std::string_view kind) {
  std::array<char, digits + 1> number{};
  std::snprintf(number.data(), number.size(), "%016llx", static_cast<unsigned long long>(random_number()));
  std::string name = target.filename().string();
  if (kind.empty()) name = name.substr(0, longest_kept);
  return target.parent_path() / ("." + name + std::string(mark) + std::string(kind) + number.data());
}

void remove_tree_of(const fs::path& folder, dev_t device) {
  std::error_code error;
  struct stat status {};
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    if (::lstat(path.c_str(), &status) != 0 || status.st_dev != device) continue;
    if (S_ISDIR(status.st_mode)) {
      remove_tree_of(path, device);
    } else {
      ::unlink(path.c_str());
    }
  }
  ::rmdir(folder.c_str());
}

}  // namespace

fs::path temporary_name(const fs::path& target) { return named_beside(target, ""); }

fs::path moved_aside_name(const fs::path& target) { return named_beside(target, aside); }

bool is_temporary_name(const fs::path& path) { return !purpose_of(path.filename().string()).target.empty(); }

fs::path lasting_folder(const fs::path& path) {
  fs::path folder;
  for (const fs::path& part : path.parent_path()) {
    const std::string target = purpose_of(part.string()).target;
    folder /= target.empty() ? part : fs::path(target);
    if (!target.empty()) return folder;
  }
  return {};
}

void remove_abandoned(const fs::path& folder) {
  std::error_code error;
  std::vector<std::pair<fs::path, Purpose>> found;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    Purpose purpose = purpose_of(entry.path().filename().string());
    if (!purpose.target.empty()) found.emplace_back(entry.path(), std::move(purpose));
  }
  for (const auto& [path, purpose] : found) remove_if_abandoned(path, purpose);
}

void remove_tree(const fs::path& folder) {
  struct stat status {};
  if (::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) remove_tree_of(folder, status.st_dev);
}

}  // namespace clearway
