#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/system/file_descriptor.hpp"

namespace clearway {

/// While one exists, what InputFile, input_place and kept_answer are asked for is kept, and what is `given`
/// is read in place of what the disk or a program has: so that what was read can be read again when it is
/// gone or another. One at a time in a process; safe from several threads.
class InputKeeper {
 public:
  /// @param given files to read by the path, or question, that is asked for
  /// @param apart files and folders of which nothing is kept
  /// @param folder that relative paths are asked for from; empty: the current one
  /// @throws std::logic_error when there is one already
  explicit InputKeeper(std::map<std::string, std::filesystem::path> given = {},
                       const std::vector<std::filesystem::path>& apart = {},
                       std::filesystem::path folder = {});
  ~InputKeeper();
  InputKeeper(const InputKeeper&) = delete;
  InputKeeper& operator=(const InputKeeper&) = delete;

  /// Contents by whole path, answers by question, both as `plain` shows them. Files of more than 100 MB are
  /// left out.
  std::map<std::string, std::string> kept() const;

 private:
  struct Store;
  friend std::filesystem::path input_place(const std::filesystem::path&);
  friend std::filesystem::path whole_input_path(const std::filesystem::path&);
  friend bool is_input_there(const std::filesystem::path&);
  friend std::string kept_answer(const std::string&, const std::function<std::string()>&);
  std::unique_ptr<Store> store_;
};

/// A file of these bytes that has no name but this, as long as it lives.
class NamelessFile {
 public:
  /// @throws std::runtime_error when there is no memory for it
  explicit NamelessFile(std::string_view bytes);

  int descriptor() const { return descriptor_.number(); }  ///< from 3 on
  std::string name() const;

 private:
  FileDescriptor descriptor_;
};

/// While one exists, what this thread reads of a file through InputFile and input_place has these bytes,
/// whatever the file has become meanwhile: for readers that open it several times. The innermost counts.
class HeldInput {
 public:
  HeldInput(std::filesystem::path file, std::string_view bytes);
  ~HeldInput();
  HeldInput(const HeldInput&) = delete;
  HeldInput& operator=(const HeldInput&) = delete;

  /// What `file` is read from; null: from the disk.
  static const NamelessFile* of(const std::filesystem::path& file);

 private:
  std::filesystem::path file_;
  NamelessFile bytes_;
  const HeldInput* outer_;
};

/// Where a file is to be opened by who does not read it through InputFile: there, or where a HeldInput has
/// its bytes, or where the InputKeeper was given it.
std::filesystem::path input_place(const std::filesystem::path& file);

/// The whole path of one that is relative to the current folder, or to the InputKeeper's. For questions.
std::filesystem::path whole_input_path(const std::filesystem::path& file);

/// Whether it is a regular file. While an InputKeeper exists, the answer is kept, too, and what it is given
/// counts: whether it is there then and what is there now.
bool is_input_there(const std::filesystem::path& file);

/// What `ask` answers, or what the InputKeeper was given for the question.
std::string kept_answer(const std::string& question, const std::function<std::string()>& ask);

/// A regular file, open for reading. Anything else (a folder, pipe, socket or device, which could keep the
/// program waiting for ever) is refused without waiting for it.
class InputFile {
 public:
  /// @param what it should be, as errors call it: "map file".
  /// @throws std::invalid_argument "<what> '<file>' cannot be read: <why>", as does `read`.
  InputFile(const std::filesystem::path& file, const std::string& what);
  /// The same in a folder that is open: a link in it may lead out of it.
  InputFile(const FileDescriptor& folder, const std::filesystem::path& file, const std::string& what);

  /// All of it, unless it has more than `largest` bytes. To be called once.
  std::string read(std::size_t largest) const;

  /// Bytes `from` to `from + count` into `piece`; fewer at the end of the file. As often as one likes.
  void read_at(std::size_t from, std::size_t count, std::string& piece) const;

  int descriptor() const { return descriptor_.number(); }
  std::size_t size() const { return size_; }

 private:
  /// Straight after it was opened: errno says why not.
  void require_regular();
  [[noreturn]] void refuse(const std::string& why) const;
  [[noreturn]] void refuse_size(std::size_t largest) const;

  std::string name_;
  FileDescriptor descriptor_;
  std::size_t size_ = 0;
};

/// A folder that stays the one that was opened, whichever takes its name meanwhile: its files are read as of
/// one moment, as long as it is unchanged in the end.
class InputFolder {
 public:
  /// @throws std::invalid_argument "folder '<folder>' cannot be read: <why>"
  explicit InputFolder(std::filesystem::path folder);

  /// All bytes of its file of that name, as read_input has them; none where there is no such file.
  /// @throws as read_input, also for a link that leads nowhere
  std::optional<std::string> read(const std::string& name, const std::string& what, std::size_t largest);

  /// Whether the folder's name still leads to it, and each file that was asked for is, or is missing, as it
  /// was then: by inode, size and times. What replaces a folder removes the files of the older one only after
  /// that has lost its name.
  bool is_unchanged() const;

 private:
  /// Device, inode, size, seconds and nanoseconds of mtime and ctime.
  using Stamp = std::array<std::int64_t, 7>;
  static std::optional<Stamp> stamp_of(const std::filesystem::path& file);

  std::filesystem::path folder_;
  FileDescriptor descriptor_;
  std::map<std::string, std::optional<Stamp>> asked_;
};

/// All bytes of a regular file of at most `largest` bytes. @throws std::invalid_argument as InputFile does.
std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest);

/// The end of a file's name that says what it holds, in small letters: ".pcd" of scan.PCD, "" without one.
std::string extension_of(const std::filesystem::path& file);

/// Refuses what read_input would refuse but for its size, for files that a library opens by their name.
void require_input(const std::filesystem::path& file, const std::string& what);

}  // namespace clearway
