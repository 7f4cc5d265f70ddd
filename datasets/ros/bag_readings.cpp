#include "datasets/ros/bag_readings.hpp"

#include <cmath>
#include <stdexcept>

#include "datasets/ros/cut_bag.hpp"

namespace clearway {

bool is_fixed(const BagTopic& topic) { return topic.name.ends_with("tf_static"); }

double time_of(const RosHeader& header, double recorded) {
  return std::isfinite(header.time) && header.time > 0.0 ? header.time : recorded;
}

std::vector<BagFrame> frames_of(MessageBag& bag) {
  TransformTree tree;
  std::vector<bool> wanted;
  for (const BagTopic& topic : bag.topics()) wanted.push_back(topic.wire && is_transforms(topic));
  bag.visit(wanted, [&](const BagMessage& message) {
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

void visit_joints(MessageBag& bag, const std::string& topic,
                  const std::function<void(double time, const RosJointState& state)>& take) {
  std::vector<bool> wanted;
  for (const BagTopic& candidate : bag.topics()) wanted.push_back(candidate.name == topic && candidate.wire);
  bag.visit(wanted, [&](const BagMessage& message) {
    try {
      WireReader in(message.bytes, *bag.topics()[message.topic].wire);
      const RosJointState state = read_joint_state(in);
      take(time_of(state.header, message.time), state);
    } catch (const std::runtime_error&) {
    }
    return true;
  });
}

}  // namespace clearway
