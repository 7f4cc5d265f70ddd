#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/message_bag.hpp"
#include "datasets/ros/ros_messages.hpp"
#include "datasets/ros/transform_tree.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Whether transforms of a topic hold for ever.
bool is_fixed(const BagTopic& topic);

/// A message's own time, or that of its recording where it has none.
double time_of(const RosHeader& header, double recorded);

/// The frames that the transforms of a bag join, read by its index; leaves out damaged ones.
std::vector<BagFrame> frames_of(MessageBag& bag);

/// What a topic's messages are like.
struct TopicContent {
  std::string frame;     ///< of the first message that could be read; empty: there is none
  std::string encoding;  ///< of that image, or the format of a compressed one
  TopicSpan recorded;
  std::optional<double> clock_offset = {};  ///< s, the stamp of that message less when it was recorded
};
/// Of each of the bag's topics, in their order; reads the whole bag where it has no index that is whole.
std::vector<TopicContent> contents_of(MessageBag& bag);

/// Calls `take` with the readings of a JointState topic, their own time where they have one, and as the
/// options say it counts; leaves out damaged ones.
void visit_joints(MessageBag& bag, const std::string& topic, const BagTopics& options,
                  const std::function<void(double time, const RosJointState& state)>& take);

}  // namespace clearway
