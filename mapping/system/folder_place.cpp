#include "mapping/system/folder_place.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

bool is_mount_point(const fs::path& folder) {
  struct statx status {};
  if (::statx(AT_FDCWD, folder.c_str(), AT_SYMLINK_NOFOLLOW, STATX_TYPE, &status) == 0 &&
      (status.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0)
    return (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
  struct stat inner {
  }, outer{};
  return ::stat(folder.c_str(), &inner) == 0 && ::stat(folder.parent_path().c_str(), &outer) == 0 &&
         inner.st_dev != outer.st_dev;
}

bool is_present_folder_or_above(const fs::path& folder) {
  std::error_code error;
  const fs::path present = fs::canonical(fs::current_path(error), error);
  return !error &&
         std::mismatch(folder.begin(), folder.end(), present.begin(), present.end()).first == folder.end();
}

void require_replaceable(const fs::path& folder, const fs::path& target) {
  if (is_present_folder_or_above(target))
    fail_to_write(folder,
                  "a folder is replaced as a whole, and this one is the present one or above it: "
                  "expected another, or to be called from elsewhere");
  if (is_mount_point(target))
    fail_to_write(folder,
                  "a folder is replaced as a whole, and this one is a mount point: expected a folder "
                  "in it, such as '" +
                      (folder / "map").string() + "'");
  if (::access(target.c_str(), R_OK | W_OK | X_OK) != 0) fail_to_write(folder);
}

}  // namespace

FolderPlace place_of_folder(const fs::path& folder) {
  std::error_code error;
  FolderPlace place;
  const auto status = fs::status(folder, error);
  place.exists = fs::exists(status);
  if (folder.empty()) fail_to_write(folder, "expected the name of a folder");
  if (place.exists && !fs::is_directory(status)) fail_to_write(folder, "it exists and is not a folder");
  if (!place.exists && fs::is_symlink(fs::symlink_status(folder, error)))
    fail_to_write(folder, "it is a link that leads nowhere");
  if (!place.exists && status.type() != fs::file_type::not_found) fail_to_write(folder, error.message());
  place.target = place.exists ? fs::canonical(folder) : fs::absolute(folder).lexically_normal();
  if (!place.target.has_filename()) place.target = place.target.parent_path();  // named with a / at its end
  if (place.exists) require_replaceable(folder, place.target);

  fs::path parent = place.target.parent_path();
  while (!fs::exists(parent, error) && parent.has_relative_path()) parent = parent.parent_path();
  if (!fs::is_directory(parent, error)) fail_to_write(folder, "'" + parent.string() + "' is not a folder");
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    fail_to_write(folder, "it is made beside its place, and '" + parent.string() +
                              "' cannot be written: " + std::strerror(errno));
  return place;
}

}  // namespace clearway
