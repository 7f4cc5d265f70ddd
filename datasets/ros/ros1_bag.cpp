// ROS 1 bags, format 2.0, by rosbag_storage.

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <exception>
#include <map>
#include <new>
#include <stdexcept>

#include "datasets/ros/message_bag.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t most_message_bytes = 1U << 30U;

class Ros1Bag final : public MessageBag {
 public:
  explicit Ros1Bag(const std::string& path) {
    try {
      bag_.open(path, rosbag::bagmode::Read);
      rosbag::View view(bag_);
      for (const rosbag::ConnectionInfo* connection : view.getConnections()) learn(*connection);
      for (const rosbag::MessageInstance& message : view) ++topics_[topic_of(message)].count;
      if (view.size() > 0) first_time_ = view.getBeginTime().toSec();
    } catch (const rosbag::BagUnindexedException&) {
      throw std::runtime_error(
          "it has no index, as its recorder was ended: expected it after `rosbag reindex`");
    } catch (const std::exception&) {
      throw std::runtime_error(
          "it is no ROS 1 bag of format 2.0, or it is cut or its index is damaged: expected it after `rosbag "
          "reindex`");
    }
  }

  std::optional<double> first_time() const override { return first_time_; }

  std::uint64_t offset() const override {
    return static_cast<std::uint64_t>(share_ * static_cast<double>(bag_.getSize()));
  }

  /// What the library throws is damage; what `take` throws goes on to the caller.
  void visit(const std::vector<bool>& wanted, const std::function<bool(const BagMessage&)>& take) override {
    std::exception_ptr thrown;
    const auto taken = [&](const BagMessage& message) {
      try {
        return take(message);
      } catch (...) {
        thrown = std::current_exception();
        return false;
      }
    };
    try {
      rosbag::View view(bag_, [&](const rosbag::ConnectionInfo* connection) {
        return wanted[topic_of_.at({connection->topic, connection->datatype})];
      });
      const double count = view.size();
      double done = 0.0;
      std::vector<std::uint8_t> bytes;
      for (const rosbag::MessageInstance& message : view) {
        share_ = done++ / count;
        if (message.size() > most_message_bytes) {
          damage_ = "a message is larger than 1 GiB; what comes after it is not read";
          break;
        }
        bytes.resize(message.size());
        ros::serialization::OStream out(bytes.data(), message.size());
        message.write(out);
        if (!taken({topic_of(message), message.getTime().toSec(), bytes})) break;
      }
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const rosbag::BagException&) {
      damage_ = "a chunk is damaged; what comes after it is not read";
    } catch (const std::exception&) {
      damage_ = "a message is damaged; what comes after it is not read";
    }
    if (thrown) std::rethrow_exception(thrown);
    share_ = 1.0;
  }

 private:
  void learn(const rosbag::ConnectionInfo& connection) {
    if (!topic_of_.try_emplace({connection.topic, connection.datatype}, topics_.size()).second) return;
    topics_.push_back({connection.topic, connection.datatype, RosWire::ros1, 0});
  }
  std::size_t topic_of(const rosbag::MessageInstance& message) const {
    return topic_of_.at({message.getTopic(), message.getDataType()});
  }

  rosbag::Bag bag_;
  std::map<std::pair<std::string, std::string>, std::size_t> topic_of_;
  std::optional<double> first_time_;
  double share_ = 0.0;
};

}  // namespace

std::unique_ptr<MessageBag> open_ros1_bag(const std::string& path) { return std::make_unique<Ros1Bag>(path); }

}  // namespace clearway
