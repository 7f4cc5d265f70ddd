#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/ros/message_bag.hpp"

namespace clearway {

/// The times of a bag's streams: of the messages of each sensor, and of each frame's transforms.
class BagClocks {
 public:
  /// @param name of the stream, for sentences @param stamp s
  void note(const std::string& name, double stamp, const BagMessage& message);

  /// @param first_time of the bag, s
  /// @throws ContradictoryBag a clause that names the stream whose clock starts again first
  void refuse_restarts(double first_time) const;
  /// As that, of a clock that was set back: the stamps fall while the times of recording rise, or both fall
  /// in the order of a file that is in order elsewhere.
  void refuse_set_back(double first_time) const;

 private:
  struct Message {
    double stamp = 0.0, recorded = 0.0;  ///< s
    BagPlace place;
  };
  using Stream = std::vector<Message>;  ///< in the order of recording

  static std::vector<double> stamps_of(const Stream& stream);
  static std::vector<double> recordings_of(const Stream& stream);
  /// The same in the order in which the file has them, as far as that is known.
  static Stream by_place(Stream stream);
  bool is_file_in_order() const;
  static void refuse_set_back(const std::string& name, const Stream& written, double first_time);

  std::map<std::string, Stream> streams_;
};

}  // namespace clearway
