#include "mapping/system/atomic_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "mapping/system/atomic_file.hpp"
#include "mapping/system/folder_place.hpp"
#include "mapping/system/temporary_name.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// What this process takes away from the permissions of new files; umask() itself cannot be asked without
/// changing it under other threads.
mode_t permissions_taken_away() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "Umask:" && status >> word) return static_cast<mode_t>(std::stoul(word, nullptr, 8));
  }
  return 0077;
}

bool is_own_folder(const fs::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::geteuid();
}

/// Whether a partial folder has a list of our files, or its process was killed before it wrote one.
bool was_left_by_us(const fs::path& folder) {
  std::error_code error;
  if (fs::is_regular_file(fs::symlink_status(folder / own_files_name, error))) return true;
  const fs::directory_iterator entries(folder, error);
  return std::all_of(begin(entries), end(entries),
                     [](const auto& entry) { return is_temporary_name(entry.path()); });
}

void sync_all_folders(const fs::path& folder, const fs::path& what) {
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_directory() && !entry.is_symlink()) sync_folder(entry.path(), what);
  sync_folder(folder, what);
}

int rename_with(const fs::path& from, const fs::path& to, unsigned flags) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags);
}

}  // namespace

AtomicFolder::AtomicFolder(const fs::path& folder, IsOurs is_ours, Unpublished unpublished)
    : folder_(folder), is_ours_(std::move(is_ours)), unpublished_(unpublished) {
  const FolderPlace place = place_of_folder(folder);
  target_ = place.target;
  existed_ = place.exists;
  if (existed_) require_no_other_command(folder_, is_ours_);
  if (existed_) require_no_file_of_others(folder_, is_ours_);
  try {
    make_parents();
    remove_abandoned(target_.parent_path());
    {
      const auto held = uninterrupted();
      unpublished_ == Unpublished::removed ? make_staging() : make_partial();
      unfinished_ = std::make_unique<UnfinishedWork>([this] { return end(); }, staging_);
    }
    if (unpublished_ != Unpublished::removed)
      save_file(staging_ / own_files_name, "");  // says that it is ours
    if (existed_) kept_.update(target_, staging_, is_ours_);
  } catch (...) {
    if (finished_.empty()) remove_staging();
    throw;
  }
}

fs::path AtomicFolder::partial_of(const fs::path& folder) {
  return place_of_folder(folder).target.string() + ".partial";
}

AtomicFolder::~AtomicFolder() {
  if (!is_published_ && unfinished_work().empty()) remove_staging();
}

void AtomicFolder::make_parents() {
  std::error_code error;
  for (fs::path parent = target_.parent_path(); !fs::exists(parent, error); parent = parent.parent_path())
    first_made_parent_ = parent;
  fs::create_directories(target_.parent_path(), error);
  if (error) fail_to_write(folder_, error.message());
}

void AtomicFolder::make_staging() {
  for (int attempt = 0; attempt < 100; ++attempt) {
    const fs::path name = temporary_name(target_);
    if (::mkdir(name.c_str(), 0700) != 0) {
      if (errno == EEXIST) continue;
      fail_to_write(folder_);
    }
    staging_ = name;
    lock_ = open_to_read(staging_);
    // Between the two calls another process may have taken it for abandoned.
    if (lock(lock_, false) && is_same_file(lock_, staging_)) return;
    remove_tree(staging_);
  }
  fail_to_write(folder_, "no temporary folder can be made beside it");
}

/// The name is known to all: only a folder that an earlier run left makes way.
void AtomicFolder::make_partial() {
  const fs::path name = target_.string() + ".partial";
  std::error_code error;
  if (fs::exists(fs::symlink_status(name, error))) {
    FileDescriptor older = open_to_read(name);
    if (!is_own_folder(name) || !was_left_by_us(name))
      fail_to_write(folder_, "it is made as '" + name.string() + "', which is in the way");
    if (!lock(older, false)) fail_to_write(folder_, "another process writes '" + name.string() + "'");
    if (unpublished_ == Unpublished::continued) {
      lock_ = std::move(older);
      finished_ = "what an earlier one finished is";
      staging_ = name;
      return;
    }
    remove_tree(name);
  }
  if (::mkdir(name.c_str(), 0700) != 0) fail_to_write(folder_);
  staging_ = name;
  lock_ = open_to_read(staging_);
  if (!lock(lock_, false)) fail_to_write(folder_, "another process writes '" + name.string() + "'");
}

void AtomicFolder::note_progress(const std::string& what_is_finished, const std::string& then) {
  const auto held = uninterrupted();
  finished_ = what_is_finished;
  then_ = then;
}

std::string AtomicFolder::unfinished_work() const {
  const auto held = uninterrupted();
  if (is_published_ || finished_.empty()) return {};
  return finished_ + " in '" + folder_.lexically_normal().string() + ".partial'" +
         (then_.empty() ? "" : "; " + then_);
}

void AtomicFolder::publish() {
  std::error_code error;
  existed_ = fs::is_directory(target_, error);
  if (existed_) {
    require_no_other_command(folder_, is_ours_);  // it may have been written meanwhile
    kept_.update(target_, staging_, is_ours_);
  }
  kept_.write_list(staging_);
  sync_all_folders(staging_, folder_);
  take_over_permissions();
  exchange();
  remove_older();
  unfinished_.reset();
  written_file(folder_);
}

void AtomicFolder::take_over_permissions() const {
  struct stat status {};
  mode_t mode = 0777U & ~permissions_taken_away();
  if (existed_ && ::stat(target_.c_str(), &status) == 0) {
    mode = status.st_mode & 07777U;
    [[maybe_unused]] const int owner = ::chown(staging_.c_str(), status.st_uid, status.st_gid);
  }
  ::chmod(staging_.c_str(), mode);
}

void AtomicFolder::exchange() {
  const auto held = uninterrupted();
  if (existed_) {
    older_lock_ = open_to_read(target_);
    lock(older_lock_, false);
  }
  take_place();
  try {
    sync_folder(target_.parent_path(), folder_);
  } catch (...) {
    leave_place();
    throw;
  }
  is_published_ = true;
}

/// In one step where the file system can exchange two names, in two where it cannot: a kill between them
/// leaves both folders whole, and the next run gives the older one its name back (remove_abandoned).
void AtomicFolder::take_place() {
  if (!existed_) {
    if (::rename(staging_.c_str(), target_.c_str()) != 0) fail_to_write(folder_);
    return;
  }
  is_exchanged_ = rename_with(staging_, target_, RENAME_EXCHANGE) == 0;
  if (is_exchanged_) {
    older_ = staging_;
    return;
  }
  if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP) fail_to_write(folder_);
  older_ = moved_aside_name(target_);
  if (::rename(target_.c_str(), older_.c_str()) != 0) fail_to_write(folder_);
  if (::rename(staging_.c_str(), target_.c_str()) == 0) return;
  const int reason = errno;
  ::rename(older_.c_str(), target_.c_str());
  fail_to_write(folder_, std::strerror(reason));
}

void AtomicFolder::leave_place() {
  if (is_exchanged_) {
    rename_with(staging_, target_, RENAME_EXCHANGE);
    return;
  }
  ::rename(target_.c_str(), staging_.c_str());
  if (existed_) ::rename(older_.c_str(), target_.c_str());
}

/// What others put into the older folder at the last moment moves over.
void AtomicFolder::remove_older() {
  if (older_.empty()) return;
  try {
    std::error_code error;
    for (const fs::path& relative : files_of_others(older_)) {
      if (fs::exists(fs::symlink_status(target_ / relative, error))) continue;
      fs::create_directories((target_ / relative).parent_path(), error);
      rename_with(older_ / relative, target_ / relative, RENAME_NOREPLACE);
    }
    remove_tree(older_);
  } catch (const std::exception&) {  // the new folder is in its place; what is left goes with the next run
  }
}

std::string AtomicFolder::end() {
  const std::string name = "'" + folder_.lexically_normal().string() + "'";
  if (is_published_) {
    remove_tree(older_);
    return name + " is written whole";
  }
  const std::string left = unfinished_work();
  if (left.empty()) remove_staging();
  return name + (existed_ ? " is as it was" : " is not written") + (left.empty() ? "" : "; " + left);
}

void AtomicFolder::remove_staging() {
  const auto held = uninterrupted();
  std::error_code error;
  for (int attempt = 0; attempt < 10 && !staging_.empty() && fs::exists(staging_, error); ++attempt)
    remove_tree(staging_);
  if (first_made_parent_.empty()) return;
  for (fs::path parent = target_.parent_path(); ::rmdir(parent.c_str()) == 0 && parent != first_made_parent_;)
    parent = parent.parent_path();
}

}  // namespace clearway
