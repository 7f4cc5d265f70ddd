#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planning/robot/load.hpp"

namespace clearway {

/// An object that stands in the map, how a robot takes it, and where it puts it (Chong et al. 2008, section
/// 4). Whoever states it says that nothing but the object is in the voxels that it reaches into. "Up" is the
/// map's z; the object stands on the horizontal plane through its lowest point.
///
/// Legs, and what holds on each beside the contract of check_path:
///   approach  from the start to the grasp less `approach`; the object is a body that nothing may touch
///   reach     straight to the grasp; the object's voxels have left the map, its shape stands in their place,
///             and only the link that carries it and `touches` may touch it, an open hand at most `depth`
///             deep. There the hand closes
///   lift      straight up; the object is the robot's load. On its first `contact` metres the load may touch
///             voxels of the support's layer, provided its lowest point never sinks below the plane that it
///             stood on by more than the padding (0.1 to 1 mm); the robot itself keeps clear of these
///   carry     to above the place
///   lower     straight down; the same on its last `contact` metres, with the layer at the place
///   retreat   the hand opens, then back along the approach, turned as the object was; as `reach`, the object
///             at its place
///   leave     to the goal, if there is one; the object, at its place, may not be touched
///
/// The object's voxels: those wholly above the plane that it reaches into, or comes within `margin` of. The
/// layer: voxels that lie wholly within the box about the object, layer_reach() wider and lower, and reach at
/// most one voxel above the plane.
struct Pick {
  /// Where a joint of the hand stands, rad or m of the robot at its scale.
  struct Grip {
    double open = 0.0, closed = 0.0;
  };

  Load object;  ///< its link_from_load is not used: it is where the grasp has it
  Eigen::Isometry3d map_from_object = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d map_from_place = Eigen::Isometry3d::Identity();  ///< of the object, afterwards
  /// Where the tip takes it, in the object's frame. One of an axial shape may be turned about its axis, and
  /// so may the place.
  Eigen::Isometry3d object_from_tip = Eigen::Isometry3d::Identity();
  Eigen::Vector3d approach{0.0, 0.0, -0.1};  ///< the tip's motion to the grasp, metres, map frame
  double lift = 0.1;                         ///< metres
  double contact = 0.0;                      ///< metres of the lift; 0: two voxels and twice the padding
  double margin = 0.0;                       ///< metres
  /// So far may the open hand reach into the object (metres), of which a hull and a pose are never quite
  /// true; at most a quarter of the object's least width. It is asked of hands with a `grip` alone: others
  /// are not as they are when they come and go.
  double depth = 0.005;
  /// The hand, by joint, of those that do not move the tip. It is open from the end of `approach` until it
  /// closes at the grasp, closed while the object rides, and open again before `retreat` leads away from the
  /// place; while it closes or opens nothing else moves. Joints that hold the object (grip_joints) and are
  /// not named stay from `reach` to `retreat` where the start has them.
  std::map<std::string, Grip> grip{};
};

/// What lies deeper than `depth` in the object (Shape::core), in the object's frame; none without a `grip`.
std::optional<Shape> core_of(const Pick& pick);

/// "can-deeper-than-5mm": the body of that core in refusals.
std::string core_name(const Pick& pick);

/// The configuration with the joints of `grip` open or closed. @pre require_grip
Eigen::VectorXd with_grip(const Robot& robot, const Pick& pick, Eigen::VectorXd q, bool is_closed);

/// @throws std::invalid_argument in one sentence: a joint of `grip` that the robot does not plan for, that
///         moves the tip, or a value outside of its limits.
void require_grip(const Robot& robot, const Pick& pick);

/// A leg's path in stretches, between which the robot rests: before the hand closes or opens, and after.
std::vector<std::vector<Eigen::VectorXd>> stretches_of(const Robot& robot, const Pick& pick,
                                                       const std::vector<Eigen::VectorXd>& path);

/// Names of the legs in order; with a goal `leave` is one more.
std::vector<std::string> names_of_legs(bool has_goal);

/// Legs on which the object rides, from 0: lift, carry and lower.
std::vector<int> legs_that_carry();

/// `contact`, chosen where it is 0. @param resolution of the map, metres
double contact_length(const Pick& pick, double resolution, double padding);

/// How far the layer reaches, metres: a voxel, the padding, and a twentieth of a voxel, for what moves
/// straight in joint space strays from a straight line.
double layer_reach(double resolution, double padding);

/// @throws std::invalid_argument in one sentence naming the field: poses and lengths that are none, an
/// approach of no length, a contact shorter than a voxel and the padding, a lift shorter than the contact.
void require_sound(const Pick& pick, double resolution, double padding);

/// The same object, grasp, place, grip and lengths, within 1e-6 m, but for `depth`, which a plan may keep to
/// more strictly than is asked.
bool is_same(const Pick& a, const Pick& b);

}  // namespace clearway
