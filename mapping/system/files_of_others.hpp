#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace clearway {

/// The name of the list of our files in a folder that is replaced as a whole: one relative name a line.
inline constexpr const char* own_files_name = ".clearway_files";

/// Whether a command writes a file of this name, relative to its folder.
using IsOurs = std::function<bool(const std::filesystem::path& relative)>;

/// Adds names to the list of our files in a folder.
/// @throws std::runtime_error when the list cannot be written.
void list_as_own(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// What in `folder` Clearway did not write, relative: files, links and empty folders that are not on its list
/// of our files. A folder without a list holds nothing of ours.
/// @throws std::runtime_error when it holds things that cannot be kept (sockets, devices, mounted file
///         systems), or more than 100,000 files of others.
std::vector<std::filesystem::path> files_of_others(const std::filesystem::path& folder);

/// Nothing of somebody else is replaced, not even under a name that we use.
/// @throws std::runtime_error naming the folder and the first of its files and links (not those of folders
///         below it) that a command would write (`is_ours`), but did not, by the list.
void require_no_file_of_others(const std::filesystem::path& folder, const IsOurs& is_ours);

/// What another command of Clearway wrote into a folder does not go when this one replaces it.
/// @throws std::runtime_error naming the folder and the first file on its list that `is_ours` denies.
void require_no_other_command(const std::filesystem::path& folder, const IsOurs& is_ours);

/// Gives the files of others in `from` a second name, a hard link, in `to`.
class KeptFiles {
 public:
  /// Brings `to` up to date; to be called again when `from` may have changed.
  /// @param is_ours whether we write a file of that name
  /// @throws std::runtime_error naming `from` and the file that cannot be kept, also because we wrote another
  ///         of that name into `to`.
  void update(const std::filesystem::path& from, const std::filesystem::path& to, const IsOurs& is_ours);

  /// Writes the list of all other files in `folder`.
  void write_list(const std::filesystem::path& folder) const;

 private:
  void keep(const std::filesystem::path& from, const std::filesystem::path& to,
            const std::filesystem::path& relative, bool is_ours);
  std::map<std::filesystem::path, unsigned long> inodes_;  ///< of the files kept, by relative name
};

}  // namespace clearway
