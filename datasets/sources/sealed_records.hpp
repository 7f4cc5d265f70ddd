#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace clearway {

/// The records of one of our own recordings (record_seal.hpp), front to back. A record that is damaged does
/// not end the reading: the next whole one is looked for behind it.
class SealedRecords {
 public:
  /// Reads from `descriptor`, which stays open and belongs to the caller.
  SealedRecords(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  /// Whether the file is sealed: a seal is found within its first megabyte.
  static bool are_in(int descriptor, std::uint64_t size);

  struct Record {
    std::optional<std::string> content;  ///< none: it, or a run of them, is lost
    std::string loss;                    ///< which, when and why, for a sentence
  };
  /// The next record; none at the end.
  std::optional<Record> next();
  /// Bytes of the file used up so far.
  std::uint64_t offset() const { return offset_; }

 private:
  std::string read(std::uint64_t at, std::size_t count) const;
  std::uint64_t find_seal(std::uint64_t from) const;
  Record lost_until(std::uint32_t index);

  int descriptor_;
  std::uint64_t size_, offset_ = 0;
  std::uint32_t expected_ = 0;  ///< index of the next record
  bool ended_ = false;
};

}  // namespace clearway
