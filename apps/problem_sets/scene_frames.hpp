#pragma once

#include <Eigen/Geometry>
#include <map>
#include <set>
#include <string>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Where the frames of scenes and requests stand in the map, whose origin is the robot's root link. They are
/// the robot's links where its state is known, what transforms place, and the frames that call themselves the
/// planning frame, in which the scene may place the robot. `world`, `map` and `odom` are the planning frame
/// where none is named.
class SceneFrames {
 public:
  SceneFrames() = default;
  /// @param planning_frames what the SRDF calls the frame in which virtual joints place the robot
  /// @param planning_from_base where the scene places the robot's root link in the planning frame
  explicit SceneFrames(const std::set<std::string>& planning_frames,
                       const Eigen::Isometry3d& planning_from_base = Eigen::Isometry3d::Identity());

  /// Places the links that no joint moves, or only joints with a value here, by the robot's own names and by
  /// those with the prefix that the joints' names have here, or that is the robot's name, as panda_hand is of
  /// hand. `link0` is the root, where the links count from a `link1` on. Replaces what it placed before.
  void place_links(const Robot& robot, const std::map<std::string, double>& joints);
  void place(const std::string& frame, const Eigen::Isometry3d& map_from_frame);
  void add_planning_frame(const std::string& frame);

  bool is_link(const std::string& frame) const;  ///< of the robot, wherever it stands
  const Eigen::Isometry3d& map_from_planning() const { return map_from_planning_; }
  bool is_planning_frame(const std::string& frame) const;
  /// None: unknown. "" is the planning frame. @param is_named leaves out `world`, `map` and `odom` without a
  /// statement
  const Eigen::Isometry3d* find(const std::string& frame, bool is_named = false) const;
  /// For sentences: "which is unknown, expected …", naming the known ones.
  std::string why_unknown(const std::string& frame) const;

 private:
  Eigen::Isometry3d map_from_planning_ = Eigen::Isometry3d::Identity();
  std::map<std::string, Eigen::Isometry3d> links_, placed_;
  std::set<std::string> unplaced_;  ///< links whose joints have no value
  bool has_planning_frame_ = false;
};

}  // namespace clearway
