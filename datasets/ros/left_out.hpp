#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/ros/transform_faults.hpp"

namespace clearway {

/// There is no pose, as one on the way jumps.
class JumpedPose : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Some of the frames that transforms join, for a sentence.
std::string list_of_frames(const std::vector<std::string>& frames);

/// Keeps what of a bag's messages cannot be used, or only in part, for the clauses that tell it.
class LeftOut {
 public:
  /// A message of the topic. @param error why: CutMessage, JumpedPose or another
  void leave_out(const std::string& topic, const std::runtime_error& error);
  /// The stamp of a sensor's message, s; 0: none. @throws ContradictoryBag for one before 1970
  void note_stamp(const std::string& topic, double stamp);
  /// Of a cloud whose frame is no sensor's.
  void note_unseen(const std::string& topic, const std::string& frame);
  /// Of a cloud in a frame of the world, of a bag without poses.
  void note_standing(const std::string& topic, const std::string& frame);
  /// Of a cloud in a frame on which sensors are mounted elsewhere. @param is_body it frees nothing, then
  void note_mounted(const std::string& topic, const std::string& frame, const MountedFrames& mounted,
                    bool is_body);
  /// A cloud during which the sensor moved. @param field of its points' times @param farthest m, of a point
  void note_motion(const std::string& topic, const std::string& field, double farthest);
  /// A cloud whose bytes have the other order than it states.
  void note_other_order(const std::string& topic);
  /// Of a laser scan whose increment leads away from its angle_max.
  void note_opposite_angles(const std::string& topic);
  /// A cloud whose points' times make no sense. @param what a clause of them
  void note_odd_times(const std::string& topic, const std::string& what);

  /// ": " and the first reason why messages of the topic were left out; "": none were.
  std::string reason(const std::string& topic) const;
  /// One clause about messages that end early; "": there is none.
  std::string damage() const;
  /// One clause for each other kind. @param frames of the bag @param by_point_times whether points of a cloud
  /// are placed at times of their own
  std::vector<std::string> clauses(const std::vector<std::string>& frames, bool by_point_times) const;

 private:
  struct Missing {
    std::size_t count = 0;
    std::string first;  ///< why, or the frame
  };
  struct Motion {
    std::size_t count = 0;
    double farthest = 0.0;  ///< m
    std::string field;
  };
  struct Stamps {
    std::size_t messages = 0, missing = 0;
  };
  static void note(std::map<std::string, Missing>& kind, const std::string& topic, const std::string& first);

  // Of the topic.
  std::map<std::string, Missing> unusable_, cut_, jumped_, odd_times_, unseen_, other_order_,
      opposite_angles_, standing_, mounted_;
  std::map<std::string, Stamps> stamps_;
  std::map<std::string, Motion> moved_;
};

}  // namespace clearway
