#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace clearway {

/// The name of the list of our files in a folder that is replaced as a whole: one relative name a line.
inline constexpr const char* own_files_name = ".clearway_files";

/// Whether a file, relative to its folder, is one that Clearway wrote.
using IsOurs = std::function<bool(const std::filesystem::path& relative)>;

/// What in `folder` Clearway did not write, relative: files, links and empty folders that are not on its list
/// of our files, or, where it has no list, that `is_ours` denies.
/// @throws std::runtime_error when it holds things that cannot be kept (sockets, devices, mounted file
///         systems), or more than 100,000 files of others.
std::vector<std::filesystem::path> files_of_others(const std::filesystem::path& folder,
                                                   const IsOurs& is_ours);

/// What another command of Clearway wrote into a folder does not go when this one replaces it.
/// @param is_ours also of a folder with a list: whether this command writes such a file
/// @throws std::runtime_error naming the folder and the first file on its list that `is_ours` denies.
void require_no_other_command(const std::filesystem::path& folder, const IsOurs& is_ours);

/// Gives the files of others in `from` a second name, a hard link, in `to`.
class KeptFiles {
 public:
  /// Brings `to` up to date; to be called again when `from` may have changed. A name that was written anew in
  /// `to` since is ours from then on.
  /// @throws std::runtime_error naming `from` and the file that cannot be kept.
  void update(const std::filesystem::path& from, const std::filesystem::path& to, const IsOurs& is_ours);

  /// Writes the list of all other files in `folder`.
  void write_list(const std::filesystem::path& folder) const;

 private:
  void keep(const std::filesystem::path& from, const std::filesystem::path& to,
            const std::filesystem::path& relative);
  std::map<std::filesystem::path, unsigned long> inodes_;  ///< of the files kept, by relative name
};

}  // namespace clearway
