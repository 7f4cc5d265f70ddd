#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/bag_readings.hpp"
#include "datasets/ros/message_bag.hpp"
#include "datasets/ros/transform_tree.hpp"
#include "datasets/sources/frame_source.hpp"
#include "datasets/sources/joint_stream.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {

/// True for names of SQLite's bags: that end in .db3, or .db3.zstd and .db3.zst, packed.
inline bool is_sqlite_bag(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".db3" || ((kind == ".zstd" || kind == ".zst") && extension_of(file.stem()) == ".db3");
}

/// True for names of ROS 1 bags: that end in .bag, or .bag.active, as one is called until its recorder ends.
inline bool is_ros1_bag(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".bag" || (kind == ".active" && extension_of(file.stem()) == ".bag");
}

/// True for names of MCAP files that are packed as a whole, .mcap.zstd and .mcap.zst, which are refused.
inline bool is_packed_mcap(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return (kind == ".zstd" || kind == ".zst") && extension_of(file.stem()) == ".mcap";
}

/// True for names that end in .mcap, in small or capital letters, and for those of SQLite's and ROS 1 bags.
inline bool is_bag_file(const std::filesystem::path& file) {
  return extension_of(file) == ".mcap" || is_packed_mcap(file) || is_sqlite_bag(file) || is_ros1_bag(file);
}

/// True for the folder that `ros2 bag record` makes: metadata.yaml beside files .mcap or .db3 (of which what
/// SQLite keeps may lie there, too); and for one of these alone, as a recorder that was ended leaves them, or
/// of files .bag alone, as `rosbag record --split` makes them.
inline bool is_bag_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const bool has_metadata = std::filesystem::exists(folder / "metadata.yaml", error);
  bool has_bags = false, has_ros1 = false, has_others = false;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string kind = extension_of(entry.path());
    const bool is_part = kind == ".mcap" || is_sqlite_bag(entry.path());
    has_bags |= is_part;
    has_ros1 |= is_ros1_bag(entry.path());
    has_others |= !is_part && !is_ros1_bag(entry.path()) && !kind.starts_with(".db3-");
  }
  if (!has_metadata && has_others) return false;
  return has_bags ? has_metadata || !has_ros1 : has_ros1 && !has_metadata;
}

inline bool is_bag(const std::filesystem::path& path) { return is_bag_file(path) || is_bag_folder(path); }

/// What a bag holds (a file, or a folder of files), in the order of names. A bag that is damaged has
/// what could be read.
/// @throws std::invalid_argument naming the file when it is no bag.
std::vector<BagTopic> list_bag(const std::filesystem::path& file);

/// What a bag holds, its messages included.
struct BagListing {
  std::vector<BagTopic> topics;                  ///< in the order of names
  std::map<std::string, TopicContent> contents;  ///< of topics by their name, but of those without messages
  std::vector<BagFrame> frames;                  ///< that its transforms join, in the order of names
  std::optional<std::string> damage;  ///< one sentence about what of that which was read is damaged
};
/// Reads what the bag's index leads to: of each topic its first message, and all transforms; all of a bag
/// that has no index, or a damaged one. @throws std::invalid_argument as list_bag
BagListing list_contents(const std::filesystem::path& file);

/// One sentence when the folder of a bag lacks some of these parts, which its metadata.yaml lists.
std::optional<std::string> missing_parts(const std::filesystem::path& folder,
                                         const std::vector<std::string>& parts);

/// The topics of a bag that the options name, as frames in the order of their times, in tf's
/// poses; the time of a frame is that of its header, where it has one. Sensors are called like their topics.
/// Frames whose pose is not known at their time, and messages that are damaged, are left out and reported.
/// Parts that the options list and the folder lacks are damage. Decoded in a child process with limits.
/// @throws std::invalid_argument naming the file and what it has instead, when a topic is missing or of
/// another type, or the camera of images is not known.
std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options);

/// The joint positions of a JointState topic, as the stream takes them: the header's times, where there are
/// some. Messages that are damaged are left out, and of others the joints that are not finite. @throws
/// std::invalid_argument as open_bag, when none is left, and where their clock starts again (find_restart).
/// @param part of the bag, by `from` and `to`
JointStream read_joints(const std::filesystem::path& file, const std::string& topic, double max_gap = 0.5,
                        const BagTopics& part = {});

}  // namespace clearway
