#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/system/atomic_file.hpp"

namespace clearway {

/// Writes ROS 2 messages as an MCAP file (mcap.dev/spec), which appears under its name when it is whole:
/// chunks of some 4 MB, Zstandard, each under its checksum and with an index of its messages, and a summary.
/// The same messages give the same bytes.
class McapWriter {
 public:
  /// @throws std::runtime_error naming the file and why it cannot be written, as do the others.
  explicit McapWriter(const std::filesystem::path& file);

  /// @param type as "sensor_msgs/msg/PointCloud2" @param definition its text, with those of its parts
  /// (ros2msg)
  std::uint16_t add_topic(const std::string& name, const std::string& type, std::string_view definition);
  /// @param seconds since 1970, not negative @param message in CDR (WireWriter)
  void write(std::uint16_t topic, double seconds, std::string_view message);
  void finish();

 private:
  struct Topic {
    std::uint64_t count = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> in_chunk;  ///< time and offset of its messages
  };
  struct Chunk {
    std::uint64_t first = 0, last = 0, at = 0, length = 0, index_length = 0, packed = 0, unpacked = 0;
    std::map<std::uint16_t, std::uint64_t> indexes;  ///< where the index of a topic's messages is
  };
  void append(std::string_view bytes);
  void end_chunk();
  void write_summary();

  AtomicFile file_;
  std::uint64_t at_ = 0;
  std::uint32_t data_crc_ = 0;
  std::string chunk_, schemas_, channels_;
  std::uint64_t first_time_ = 0, last_time_ = 0;  ///< of the chunk
  std::vector<Topic> topics_;
  std::map<std::string, std::uint16_t> schema_of_;
  std::vector<Chunk> chunks_;
};

}  // namespace clearway
