#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mapping/system/input_file.hpp"

namespace clearway {

/// The bytes of an SQLite database as they count, read and never written: those of its file, and for pages
/// that its write-ahead log (FILE-wal) holds, the last that were committed there. A file packed by Zstandard
/// is unpacked into memory. To be made in a child process with limits.
class DatabaseBytes {
 public:
  /// @throws std::runtime_error a clause that says why it is no database that can be read as it is.
  /// @throws std::invalid_argument as InputFile
  explicit DatabaseBytes(const std::filesystem::path& file);

  /// As the database says itself: more than there are where its file ends early.
  std::uint64_t size() const { return size_; }
  /// Whether they are all in memory.
  bool is_packed() const { return !unpacked_.empty(); }
  /// All of `count` bytes. False: some are not there, or cannot be read.
  bool read(std::uint64_t at, std::size_t count, std::uint8_t* to) const;
  /// One clause about what is not there; empty: nothing.
  const std::string& damage() const { return damage_; }

 private:
  void unpack();
  void refuse_journal(const std::filesystem::path& file) const;
  void take_log(const std::filesystem::path& file);
  bool read_file(std::uint64_t at, std::size_t count, std::uint8_t* to) const;
  void report_damage(const std::string& what);

  InputFile input_;
  std::vector<std::uint8_t> unpacked_;
  std::unique_ptr<InputFile> log_;
  std::map<std::uint32_t, std::uint64_t> in_log_;  ///< where the log has a page, by its number
  std::uint64_t present_ = 0, size_ = 0;           ///< bytes: of the file; of the database
  std::uint32_t page_size_ = 0;
  std::string damage_;
};

}  // namespace clearway
