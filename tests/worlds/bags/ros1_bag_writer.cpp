#include "tests/worlds/bags/ros1_bag_writer.hpp"

#include <fcntl.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <unistd.h>

#include "datasets/bags/mcap_writer.hpp"
#include "datasets/ros/message_bag.hpp"
#include "tests/worlds/bags/sqlite_bag_writer.hpp"

namespace {

/// A message that is bytes already.
struct RawMessage {
  std::string type;
  std::span<const std::uint8_t> bytes;
};

}  // namespace

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<RawMessage> {
  static const char* value(const RawMessage&) { return "00000000000000000000000000000000"; }
};
template <>
struct DataType<RawMessage> {
  static const char* value(const RawMessage& message) { return message.type.c_str(); }
};
template <>
struct Definition<RawMessage> {
  static const char* value(const RawMessage&) { return ""; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<RawMessage> {
  template <class Stream>
  static void write(Stream& stream, const RawMessage& message) {
    std::copy(message.bytes.begin(), message.bytes.end(), stream.advance(serializedLength(message)));
  }
  static std::uint32_t serializedLength(const RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace clearway::worlds {

void write_ros1_bag(const std::filesystem::path& bag, const std::filesystem::path& mcap,
                    const std::string& compression) {
  const int file = ::open(mcap.c_str(), O_RDONLY | O_CLOEXEC);
  const auto source = open_mcap(file, std::filesystem::file_size(mcap));
  rosbag::Bag out(bag.string(), rosbag::bagmode::Write);
  if (compression == "lz4") out.setCompression(rosbag::compression::LZ4);
  if (compression == "bz2") out.setCompression(rosbag::compression::BZ2);
  source->visit(std::vector<bool>(source->topics().size(), true), [&](const BagMessage& message) {
    const BagTopic& topic = source->topics()[message.topic];
    out.write(topic.name, ros::Time(message.time), RawMessage{topic.type, message.bytes});
    return true;
  });
  out.close();
  ::close(file);
}

void write_ros1_bag(const std::filesystem::path& bag, const std::vector<BagRecord>& records) {
  rosbag::Bag out(bag.string(), rosbag::bagmode::Write);
  for (const BagRecord& record : records) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(record.bytes.data());
    out.write(record.topic, ros::Time(record.time), RawMessage{record.type, {first, record.bytes.size()}});
  }
  out.close();
}

void write_bag(const std::filesystem::path& file, const std::vector<BagRecord>& records, bool is_ros1) {
  if (is_ros1) return write_ros1_bag(file, records);
  if (file.extension() == ".db3") return write_sqlite_bag(file, records);
  McapWriter bag(file);
  std::map<std::string, std::uint16_t> topics;
  for (const BagRecord& record : records) {
    if (!topics.contains(record.topic)) topics[record.topic] = bag.add_topic(record.topic, record.type, "");
    bag.write(topics.at(record.topic), record.time, record.bytes);
  }
  bag.finish();
}

}  // namespace clearway::worlds
