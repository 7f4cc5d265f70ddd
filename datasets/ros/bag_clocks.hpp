#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/message_bag.hpp"

namespace clearway {

/// The times of a bag's streams: of the messages of each sensor, and of each frame's transforms.
class BagClocks {
 public:
  /// Where the stamps of two streams differ from when they were recorded by more than a second, in the
  /// middle.
  struct Offset {
    std::string name, other;
    double ahead = 0.0;       ///< s, of the first one's stamps
    bool do_overlap = false;  ///< what the first one says lies at times of the other, too
  };
  /// @param name of the stream, for sentences @param stamp s
  void note(const std::string& name, double stamp, const BagMessage& message);

  /// @param first_time of the bag, s
  /// @throws ContradictoryBag a clause that names the stream whose clock starts again first
  void refuse_restarts(double first_time) const;
  /// As that, of a clock that was set back: the stamps fall while the times of recording rise, or both fall
  /// in the order of a file that is in order elsewhere.
  /// @param names of the streams that count
  void refuse_set_back(const std::vector<std::string>& names, double first_time) const;

  /// Of two streams of at least three messages each; nothing: they agree, or it cannot be told, as where they
  /// were recorded apart, in batches, or at a distance that changes.
  std::optional<Offset> offset_between(const std::string& name, const std::string& other) const;
  /// @param sensors names of streams: of these no two may differ by more than five seconds
  /// @returns clauses about those that differ by less, as of drivers that are late
  /// @throws ContradictoryBag a clause that names two streams
  std::vector<std::string> refuse_offsets(const std::vector<std::string>& sensors) const;
  /// As that, of poses against what they place, where some lie at its times: those may be ten seconds after
  /// what they belong to, as of programs that compute them.
  std::vector<std::string> refuse_pose_offsets(const std::vector<std::string>& sensors,
                                               const std::vector<std::string>& poses) const;
  std::vector<std::string> names() const;

 private:
  struct Message {
    double stamp = 0.0, recorded = 0.0;  ///< s
    BagPlace place;

    double lead() const { return stamp - recorded; }
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
