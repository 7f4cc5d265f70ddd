#include "datasets/ros/bag_readings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "datasets/ros/cut_bag.hpp"

namespace clearway {
namespace {

/// Whether messages of this type begin with a header.
bool has_header(const std::string& type) {
  constexpr std::array kinds{"sensor_msgs/Image",     "sensor_msgs/CompressedImage", "sensor_msgs/CameraInfo",
                             "sensor_msgs/LaserScan", "sensor_msgs/PointCloud2",     "sensor_msgs/Imu",
                             "sensor_msgs/Range",     "sensor_msgs/JointState",      "nav_msgs/Odometry",
                             "nav_msgs/Path"};
  return std::find(kinds.begin(), kinds.end(), type) != kinds.end() || is_livox_cloud(type) ||
         (type.starts_with("geometry_msgs/") && type.ends_with("Stamped"));
}

/// @returns whether it could be read; else nothing is changed
bool read_head(const BagTopic& topic, const BagMessage& message, TopicContent& content) {
  try {
    WireReader in(message.bytes, *topic.wire), again(message.bytes, *topic.wire);
    const RosHeader header = read_header(in);
    if (topic.type == "sensor_msgs/Image") content.encoding = read_image(again).encoding;
    if (topic.type == "sensor_msgs/CompressedImage") content.encoding = read_compressed_image(again).format;
    content.frame = header.frame;
    if (std::isfinite(header.time) && header.time > 0.0) content.clock_offset = header.time - message.time;
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::vector<TopicContent> contents_by_index(MessageBag& bag, const std::vector<TopicSpan>& spans) {
  std::vector<TopicContent> contents(spans.size());
  for (std::size_t i = 0; i < spans.size(); ++i) {
    contents[i].recorded = spans[i];
    const BagTopic& topic = bag.topics()[i];
    if (topic.count == 0 || !topic.wire || !has_header(topic.type)) continue;
    std::vector<bool> only(spans.size(), false);
    only[i] = true;
    bag.visit_by_index(only,
                       [&](const BagMessage& message) { return !read_head(topic, message, contents[i]); });
  }
  return contents;
}

}  // namespace

bool is_fixed(const BagTopic& topic) { return topic.name.ends_with("tf_static"); }

double time_of(const RosHeader& header, double recorded) {
  return std::isfinite(header.time) && header.time > 0.0 ? header.time : recorded;
}

std::vector<BagFrame> frames_of(MessageBag& bag) {
  TransformTree tree;
  std::vector<bool> wanted;
  for (const BagTopic& topic : bag.topics()) wanted.push_back(topic.wire && is_transforms(topic));
  bag.visit_by_index(wanted, [&](const BagMessage& message) {
    const BagTopic& topic = bag.topics()[message.topic];
    try {
      WireReader in(message.bytes, *topic.wire);
      for (const RosTransform& transform : read_transforms(in))
        tree.add(transform, is_fixed(topic), message.time);
    } catch (const std::runtime_error&) {
    }
    return true;
  });
  return tree.edges();
}

std::vector<TopicContent> contents_of(MessageBag& bag) {
  if (const auto spans = bag.spans()) return contents_by_index(bag, *spans);
  std::vector<TopicContent> contents(bag.topics().size());
  std::vector<bool> wants_head;
  for (const BagTopic& topic : bag.topics()) wants_head.push_back(topic.wire && has_header(topic.type));
  bag.visit(std::vector<bool>(contents.size(), true), [&](const BagMessage& message) {
    const std::size_t at = message.topic;
    contents[at].recorded.add(message.time);
    if (wants_head[at]) wants_head[at] = !read_head(bag.topics()[at], message, contents[at]);
    return true;
  });
  return contents;
}

void visit_joints(MessageBag& bag, const std::string& topic, const BagTopics& options,
                  const std::function<void(double time, const RosJointState& state)>& take) {
  std::vector<bool> wanted;
  for (const BagTopic& candidate : bag.topics()) wanted.push_back(candidate.name == topic && candidate.wire);
  bag.visit(wanted, [&](const BagMessage& message) {
    try {
      WireReader in(message.bytes, *bag.topics()[message.topic].wire);
      const RosJointState state = read_joint_state(in);
      take(options.time_of(topic, time_of(state.header, message.time), message.time), state);
    } catch (const std::runtime_error&) {
    }
    return true;
  });
}

}  // namespace clearway
