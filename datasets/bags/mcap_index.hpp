#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "datasets/bags/mcap_records.hpp"

namespace clearway {

/// The indexes that lie behind the chunks of an MCAP file: which messages are in each, and when they were
/// recorded.
class McapIndex {
 public:
  /// The messages of one channel in a chunk.
  struct Channel {
    std::uint16_t id = 0;
    std::uint64_t at = 0, size = 0;  ///< of the content of their record, bytes
  };
  struct Entry {
    std::uint64_t offset = 0;  ///< of the message's record among those of the chunk, bytes
    std::uint64_t time = 0;    ///< ns
    std::uint16_t channel = 0;
  };

  /// The content of a record behind the chunk that begins at `chunk`; one that is damaged is left out.
  void add(std::uint64_t chunk, mcap::Bytes content, std::uint64_t at);
  /// Calls `take` with the entries of such a record. @returns its channel @throws std::runtime_error
  static std::uint16_t read(mcap::Bytes content, const std::function<void(const Entry&)>& take);

  /// Whether as many messages of each channel are listed.
  bool lists(const std::map<std::uint16_t, std::uint64_t>& counts) const;
  const std::vector<Channel>& channels_at(std::uint64_t chunk) const;
  /// The first and the last one of each channel, ns.
  const std::map<std::uint16_t, std::pair<std::uint64_t, std::uint64_t>>& times() const { return times_; }

 private:
  std::map<std::uint64_t, std::vector<Channel>> chunks_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::map<std::uint16_t, std::pair<std::uint64_t, std::uint64_t>> times_;
};

}  // namespace clearway
