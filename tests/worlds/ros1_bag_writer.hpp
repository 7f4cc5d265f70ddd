#pragma once

#include <filesystem>

namespace clearway::worlds {

/// Writes the messages of an MCAP file in ROS 1's encoding as a ROS 1 bag, by rosbag_storage.
void write_ros1_bag(const std::filesystem::path& bag, const std::filesystem::path& mcap, bool packed);

}  // namespace clearway::worlds
