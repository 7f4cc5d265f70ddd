#include "mapping/system/files_of_others.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <system_error>

#include "mapping/system/atomic_file.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "mapping/system/temporary_name.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 100'000;

/// None in a folder without a list.
std::set<fs::path> own_files(const fs::path& folder) {
  std::error_code error;
  std::set<fs::path> names;
  const fs::path list = folder / own_files_name;
  if (!fs::is_regular_file(fs::symlink_status(list, error))) return names;
  std::ifstream stream(list);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) names.insert(line);
  return names;
}

/// One name a line, in the order of their texts.
void save_list(const fs::path& folder, const std::set<fs::path>& own) {
  std::set<std::string> names;
  for (const fs::path& relative : own) names.insert(relative.generic_string());
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  save_file(folder / own_files_name, text);
}

/// Looks through one folder after the other.
class Search {
 public:
  explicit Search(const fs::path& folder) : folder_(folder), own_(own_files(folder)) {
    struct stat status {};
    if (::lstat(folder.c_str(), &status) == 0) device_ = status.st_dev;
  }

  std::vector<fs::path> found;

  /// Whether there is anything in the folder.
  bool look_in(const fs::path& relative) {
    std::error_code error;
    bool is_any = false;
    for (const auto& entry : fs::directory_iterator(folder_ / relative, error)) {
      look_at(relative / entry.path().filename());
      is_any = true;
    }
    if (error) fail_to_write(folder_, "it holds '" + relative.string() + "': " + error.message());
    return is_any;
  }

 private:
  void look_at(const fs::path& relative) {
    struct stat status {};
    if (::lstat((folder_ / relative).c_str(), &status) != 0) return;  // gone since
    const bool is_file = S_ISREG(status.st_mode);
    if (is_file && (relative == own_files_name || is_temporary_name(relative))) return;
    if (is_file && own_.contains(relative)) return;
    const bool is_folder = S_ISDIR(status.st_mode);
    if ((!is_file && !is_folder && !S_ISLNK(status.st_mode)) || status.st_dev != device_)
      fail_to_write(folder_, "it holds '" + relative.string() +
                                 "', which cannot be kept when the folder is replaced: expected a folder "
                                 "that is ours alone");
    if (is_folder && look_in(relative)) return;
    found.push_back(relative);
    if (found.size() > most_files)
      fail_to_write(folder_,
                    "it holds more than 100,000 files of others: expected a folder that is ours "
                    "alone");
  }

  const fs::path& folder_;
  std::set<fs::path> own_;
  dev_t device_ = 0;
};

[[noreturn]] void fail_to_replace(const fs::path& folder, const fs::path& theirs) {
  fail_to_write(folder, "it holds '" + theirs.string() + "', which this command would replace, but '" +
                            own_files_name + "' there does not name it as Clearway's: expected a new or " +
                            "another folder");
}

unsigned long inode(const fs::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(path, error));
}

/// The owner, group and permissions of a folder for another, as far as this user may give them.
void give_permissions(const fs::path& from, const fs::path& to) {
  struct stat status {};
  if (::lstat(from.c_str(), &status) != 0) return;
  [[maybe_unused]] const int owner = ::lchown(to.c_str(), status.st_uid, status.st_gid);
  ::chmod(to.c_str(), status.st_mode & 07777U);  // behind it, which takes the set-group bit away
}

/// The folders that lead to `relative`, with owner, group and permissions that they have in `from`.
void make_folders(const fs::path& from, const fs::path& to, const fs::path& relative) {
  std::error_code error;
  fs::path made;
  for (const fs::path& part : relative) {
    made /= part;
    const bool is_new = fs::create_directory(to / made, from / made, error);
    if (is_new) give_permissions(from / made, to / made);
    if (error && !is_folder(to / made)) fail_to_write(from, error.message());
  }
}

}  // namespace

void list_as_own(const fs::path& folder, const std::vector<std::string>& names) {
  std::set<fs::path> own = own_files(folder);
  own.insert(names.begin(), names.end());
  save_list(folder, own);
}

std::vector<fs::path> files_of_others(const fs::path& folder) {
  Search search(folder);
  search.look_in("");
  return std::move(search.found);
}

void require_no_file_of_others(const fs::path& folder, const IsOurs& is_ours) {
  const std::set<fs::path> own = own_files(folder);
  std::set<fs::path> theirs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path name = entry.path().filename();
    const bool is_below = entry.is_directory(error) && !entry.is_symlink(error);
    if (!is_below && is_ours(name) && !own.contains(name)) theirs.insert(name);
  }
  if (!theirs.empty()) fail_to_replace(folder, *theirs.begin());
}

void require_no_other_command(const fs::path& folder, const IsOurs& is_ours) {
  std::error_code error;
  for (const fs::path& relative : own_files(folder)) {
    if (is_ours(relative) || !fs::exists(fs::symlink_status(folder / relative, error))) continue;
    fail_to_write(folder, "it holds '" + relative.string() +
                              "', which another command wrote and this one would remove: expected another "
                              "folder");
  }
}

void KeptFiles::update(const fs::path& from, const fs::path& to, const IsOurs& is_ours) {
  for (const fs::path& relative : files_of_others(from)) keep(from, to, relative, is_ours(relative));
}

void KeptFiles::keep(const fs::path& from, const fs::path& to, const fs::path& relative, bool is_ours) {
  if (is_folder(from / relative)) return make_folders(from, to, relative);
  const unsigned long source = inode(from / relative), present = inode(to / relative);
  if (const auto known = inodes_.find(relative); known != inodes_.end()) {
    if (present != known->second) fail_to_replace(from, relative);
    if (present == source) return;
    ::unlink((to / relative).c_str());  // replaced by its owner
  } else if (present != 0) {
    if (present == source) {
      inodes_[relative] = source;  // linked by an earlier one that did not end
      return;
    }
    if (is_ours) fail_to_replace(from, relative);
    ::unlink((to / relative).c_str());  // linked by an earlier one, and replaced by its owner since
  }
  make_folders(from, to, relative.parent_path());
  if (::linkat(AT_FDCWD, (from / relative).c_str(), AT_FDCWD, (to / relative).c_str(), 0) != 0) {
    if (errno == ENOENT) return;  // gone since
    fail_to_write(from, "it holds '" + relative.string() + "', which cannot be kept when the folder is " +
                            "replaced (" + std::strerror(errno) + "): expected a folder that is ours alone");
  }
  inodes_[relative] = source;
}

void KeptFiles::write_list(const fs::path& folder) const {
  std::set<fs::path> own;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path relative = entry.path().lexically_relative(folder);
    if (entry.is_regular_file() && !entry.is_symlink() && relative != own_files_name &&
        !inodes_.contains(relative))
      own.insert(relative);
  }
  save_list(folder, own);
}

}  // namespace clearway
