#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "datasets/ros/message_bag.hpp"

namespace clearway {

/// The times of a bag's streams: of the messages of each sensor, and of each frame's transforms.
class BagClocks {
 public:
  /// @param name of the stream, for sentences @param stamp s
  void note(const std::string& name, double stamp, const BagMessage& message) {
    Stream& stream = streams_[name];
    stream.stamps.push_back(stamp);
    stream.recorded.emplace_back(message.place, message.time);
  }

  /// @param first_time of the bag, s
  /// @throws ContradictoryBag a clause that names the stream whose clock starts again first
  void refuse_restarts(double first_time) const;

 private:
  struct Stream {
    std::vector<double> stamps;                         ///< s
    std::vector<std::pair<BagPlace, double>> recorded;  ///< where, and when, s
  };
  std::map<std::string, Stream> streams_;
};

}  // namespace clearway
