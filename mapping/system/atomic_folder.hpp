#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "mapping/system/file_descriptor.hpp"
#include "mapping/system/files_of_others.hpp"
#include "mapping/system/interruption.hpp"

namespace clearway {

/// What becomes of an AtomicFolder that was not published.
enum class Unpublished {
  removed,  ///< it is removed
  kept,     ///< it stays as `FOLDER.partial`, for a person to look at, until the next one of that name begins
  continued  ///< as kept, and goes on with what an earlier one left there
};

/// A folder of files that appears under its name whole or not at all. It is filled beside its place (path())
/// and takes the place of an older folder in one step, by publish(): renameat2(RENAME_EXCHANGE), so that at
/// any moment the name leads to the older or to the new one. Before that, and after an error, a signal or a
/// kill, the older folder is as it was.
///
/// What Clearway did not write stays: files in the older folder that are not on its list of our files
/// (`.clearway_files`, written with the folder) get a hard link in the new folder before the exchange. Where
/// one has a name that the new folder needs for itself, the older folder stays.
class AtomicFolder {
 public:
  /// Makes the folder to fill, readable by this user alone. A link to a folder is followed.
  /// @param is_ours whether this command writes a file of that name
  /// @throws std::runtime_error in one sentence when the folder cannot be replaced as a whole: it or its
  ///         parent cannot be written, it is a mount point, the present folder or above it, or holds things
  ///         of others that cannot be kept or whose name is needed (require_no_file_of_others), or files that
  ///         another command wrote (require_no_other_command).
  AtomicFolder(const std::filesystem::path& folder, IsOurs is_ours,
               Unpublished unpublished = Unpublished::removed);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Where one that is kept or continued is filled: beside `folder`, or beside what that leads to.
  static std::filesystem::path partial_of(const std::filesystem::path& folder);

  /// Where the new files are written.
  const std::filesystem::path& path() const { return staging_; }

  /// For Unpublished::kept: what is in it by now, as "3 problems are"; before the first call it is removed,
  /// and after one with "".
  /// @param then a clause about what can be done with it; empty: none
  void note_progress(const std::string& what_is_finished, const std::string& then = "");
  /// A clause about what is there when the work ends now; empty when there is nothing to say.
  std::string unfinished_work() const;

  /// Syncs everything to the disk and puts it in the place of the older folder, which is then removed.
  /// @throws std::runtime_error naming the folder, also where another command has written it since; the older
  /// one is then in its place.
  void publish();

 private:
  void make_parents();
  void make_staging();
  void make_partial();
  void hold(const std::filesystem::path& staging);
  void take_over_permissions() const;
  void exchange();
  void take_place();
  void leave_place();
  void remove_older();
  std::string end();
  void remove_staging();

  std::filesystem::path folder_, target_, staging_, older_;
  std::filesystem::path first_made_parent_;
  IsOurs is_ours_;
  Unpublished unpublished_;
  bool existed_ = false, is_exchanged_ = false, is_published_ = false;
  std::string finished_, then_;
  KeptFiles kept_;
  FileDescriptor lock_, older_lock_;
  std::unique_ptr<UnfinishedWork> unfinished_;
};

}  // namespace clearway
