#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/ros/transform_tree.hpp"

namespace clearway {

/// A bag that is whole, but says of one time that things are in two places.
class ContradictoryBag : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The frames whose poses say where these are.
std::set<std::string> used_frames(const TransformTree& tree, const std::string& root,
                                  const std::set<std::string>& sensors);

/// Whether frames below this one drive while it stands in `root`, or moves less than they do, as below a map
/// and an odometry's frame: what is measured in it was put there, and not seen from its origin.
bool is_driven_in(const TransformTree& tree, const std::string& root, const std::string& frame);

/// Frames of the world that something drives in: REP 105's, and that of programs that register clouds (LOAM
/// and its heirs).
bool is_start_name(const std::string& frame);
/// map, world or earth.
bool is_world_name(const std::string& frame);
/// A vehicle's or a robot's own, as base_link, chassis or left_base_link.
bool is_body_name(const std::string& frame);

/// As `velodyne`, `front_lidar` or `camera_depth_frame`; a body's is none.
bool is_sensor_name(const std::string& frame);

/// The frames at this time below another one and more than 0.1 m from its origin: those with the name of a
/// sensor of points, or all where there is none.
struct MountedFrames {
  std::vector<std::string> names;  ///< sorted
  double farthest = 0.0;           ///< m
  bool are_sensors = false;
};
/// @param recorded s since 1970
MountedFrames mounted_on(const TransformTree& tree, const std::string& frame, double time, double recorded);

/// @param sensors frames of sensors that are placed in `root`
/// @throws ContradictoryBag a clause: on the way from these to the root a frame is in a loop, has two parents
/// by which it leads there (or none does), or alternates between places.
void refuse_contradictions(const TransformTree& tree, const std::string& root,
                           const std::set<std::string>& sensors);

/// A clause for each thing that can be used, but is to be told: single poses that contradict others, fixed
/// frames that are moved, frames with a second parent.
std::vector<std::string> tell_contradictions(const TransformTree& tree, const std::string& root,
                                             const std::set<std::string>& sensors);

/// A clause where the base of the robot moves in `root`, as a mobile robot's does, though it is taken to
/// stand; else empty.
std::string tell_moving_base(const TransformTree& tree, const std::string& root, const std::string& base);

}  // namespace clearway
