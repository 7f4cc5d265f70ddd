#pragma once

#include <memory>

#include "datasets/ros/message_bag.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Whether a topic is one of tf's.
inline bool is_transforms(const BagTopic& topic) {
  return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
}

/// The messages of a bag that were recorded from `topics.from` s after its first message on and before
/// `topics.to`; those of tf_static whenever they were, as they hold for all of it. Other transforms and poses
/// that were recorded at most 2 s before or after that part come too, as `is_beyond`: poses at its ends lie
/// between them and those in it. The bag itself where the topics name no such part.
std::unique_ptr<MessageBag> cut_bag(std::unique_ptr<MessageBag> bag, const BagTopics& topics);

/// Whether such a cut can part what was recorded before the message with this index from the rest: s after
/// `first`, a moment between both. Nothing: they were not recorded one after the other.
/// @param recorded s, when the messages were @param restart > 0
std::optional<double> cut_before(std::span<const double> recorded, std::size_t restart, double first);

}  // namespace clearway
