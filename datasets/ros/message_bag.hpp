#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/ros/wire_reader.hpp"

namespace clearway {

/// Messages of one name and type in a bag.
struct BagTopic {
  std::string name;
  std::string type;             ///< as "sensor_msgs/Image", for both versions of ROS
  std::optional<RosWire> wire;  ///< none: encoded in a way that is not known here
  std::uint64_t count = 0;      ///< messages
};

/// When messages of a topic were recorded, s since 1970; before any, `last` is less than `first`.
struct TopicSpan {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();

  void add(double time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
  void add(const TopicSpan& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
};

/// Where a message lies: of one topic, later ones are greater. All equal where that is not known.
struct BagPlace {
  std::uint64_t part = 0, chunk = 0, message = 0;
  auto operator<=>(const BagPlace&) const = default;
};

struct BagMessage {
  std::size_t topic = 0;                ///< index into topics
  double time = 0;                      ///< s since 1970, when it was recorded
  std::span<const std::uint8_t> bytes;  ///< until the next message is taken
  BagPlace place = {};
  bool is_beyond = false;  ///< of the part that is wanted, shortly before or after it (cut_bag)
};

/// A recording of ROS messages. Libraries below may crash on hostile files: to be opened in a child process
/// with limits (DecodingChild).
class MessageBag {
 public:
  virtual ~MessageBag() = default;

  const std::vector<BagTopic>& topics() const { return topics_; }
  /// One clause about what is damaged and not used; empty: nothing, up to what has been read.
  const std::string& damage() const { return damage_; }

  /// Calls `take` with the messages of these topics in the order of their times; those of one time as the
  /// file has them. Returning false ends it.
  virtual void visit(const std::vector<bool>& topics, const std::function<bool(const BagMessage&)>& take) = 0;
  /// As `visit`, but reads no more of the file than its index leads to: damage elsewhere is not noticed.
  /// Without an index that is whole, as `visit`.
  virtual void visit_by_index(const std::vector<bool>& topics,
                              const std::function<bool(const BagMessage&)>& take) {
    visit(topics, take);
  }
  /// By the file's index, of each topic in their order; nothing: it has none that is whole.
  virtual std::optional<std::vector<TopicSpan>> spans() const { return std::nullopt; }
  /// When the first message was recorded, s since 1970; nothing: there is none.
  virtual std::optional<double> first_time() const = 0;
  /// Of a part of a bag (cut_bag): a clause that says that no message visited lies in it, and where they lie;
  /// empty: some do, or there are none.
  virtual std::string why_none() const { return ""; }
  /// How much of the file `visit` has been through, bytes.
  virtual std::uint64_t offset() const = 0;

 protected:
  std::vector<BagTopic> topics_;
  std::string damage_;
};

/// MCAP (mcap.dev/spec) with messages in ROS 2's CDR or ROS 1's encoding; chunks plain, LZ4 or Zstandard,
/// each under its checksum where it has one. A file without an end (its recorder was killed) is read up to
/// there.
/// @param file descriptor of a regular file, which stays open as long as this
/// @throws std::runtime_error a clause that says why it is no MCAP file.
std::unique_ptr<MessageBag> open_mcap(int file, std::uint64_t size);

/// A ROS 1 bag, format 2.0, by rosbag_storage. @param path of a file that this process may open
/// @throws std::runtime_error a clause that says why it is none.
std::unique_ptr<MessageBag> open_ros1_bag(const std::string& path);

/// A ROS 2 bag of rosbag2's plugin sqlite3, also packed by Zstandard as a whole or message by message. What a
/// recorder that was ended left in a write-ahead log counts. Nothing is written beside it.
/// @param file that this process may open @throws std::runtime_error a clause that says why it is none.
std::unique_ptr<MessageBag> open_sqlite_bag(const std::filesystem::path& file);

}  // namespace clearway
