#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::worlds {

/// Writes the messages of an MCAP file in ROS 1's encoding as a ROS 1 bag, by rosbag_storage.
/// @param compression none, lz4 or bz2
void write_ros1_bag(const std::filesystem::path& bag, const std::filesystem::path& mcap,
                    const std::string& compression);

/// A message, encoded.
struct BagRecord {
  std::string topic, type;
  double time = 0;
  std::string bytes;
};
/// Writes a ROS 1 bag of messages, by rosbag_storage.
void write_ros1_bag(const std::filesystem::path& bag, const std::vector<BagRecord>& records);

/// The same, or CDR messages: as SQLite where the file's name ends in .db3, else as MCAP.
void write_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records, bool is_ros1);

}  // namespace clearway::worlds
