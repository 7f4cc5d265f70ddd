#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/problem_sets/scene_frames.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/robot/goal_configurations.hpp"

namespace clearway {

/// One of many boxes with axes along those of their solid.
struct ForeignCube {
  Eigen::Vector3d center;
  double edge;
};

/// An object's piece; a mesh, of which the surface alone counts, as collision checkers of meshes have it; or
/// cubes of an octomap.
struct ForeignSolid {
  std::string object;  ///< its name in the problem set
  std::string kind;    ///< "box", "sphere", "cylinder", "cone", "mesh", "plane", "octomap"
  Shape shape = Shape::sphere(1.0);
  Eigen::Isometry3d map_from_shape =
      Eigen::Isometry3d::Identity();         ///< of what is attached: frame_from_shape
  std::vector<Eigen::Vector3d> triangles{};  ///< corners of a mesh, three by three; then `shape` says nothing
  std::vector<ForeignCube> cubes{};          ///< of an octomap; then `shape` says nothing
};

/// An object that rides on a link from the start on.
struct ForeignAttached {
  std::string name, link;
  std::string frame;  ///< of its pieces' poses: a link, where it is at the start; empty: the map there
  std::vector<std::string> touches;  ///< links, and what else is named, that may touch it
  std::vector<ForeignSolid> pieces;  ///< none: the file shows no shape of it
  double weight = 0.0;               ///< kg, of all pieces together
};

/// A body that is taken off the robot: all of `link` when it has no name.
struct ForeignDetached {
  std::string name, link;
};

struct ForeignWorld {
  std::string name;
  std::vector<ForeignSolid> solids;
  std::map<std::string, double> joints = {};   ///< where the robot stands, unless a problem says otherwise
  std::vector<ForeignAttached> attached = {};  ///< in the robot's hand, unless a problem says otherwise
  /// Links of the robot that may touch an object, by its name: it stands as a body of the robot's root, which
  /// they may touch, and takes no voxels. Its solids have shapes or meshes.
  std::map<std::string, std::vector<std::string>> touched = {};
  std::filesystem::path folder = {};  ///< of its file
  SceneFrames frames = {};            ///< where the robot stands as `joints` say
};

/// A configuration as a problem set states it: by the joints' names, or in the robot's own order.
struct ForeignState {
  std::map<std::string, double> by_joint;
  std::vector<double> values;
};

/// A link at a pose.
struct ForeignPose {
  std::string link;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of the link, in its frame: what stands at the pose
  GoalPose pose;                                    ///< of the link's axes about that point
};

/// What a constraint on a joint allows: from position - below to position + above, rad or m.
struct JointBand {
  std::string joint;
  double position = 0.0, below = 0.0, above = 0.0;
};

/// Joint values, or a pose, or both at once.
struct ForeignGoal {
  ForeignState joints;
  std::optional<ForeignPose> pose{};
  std::vector<JointBand> bands{};  ///< all of a joint's hold; `joints` has the first one's position

  bool has_joints() const { return !joints.by_joint.empty() || !joints.values.empty(); }
};

struct ForeignProblem {
  std::string name, experiment;
  std::size_t world = 0;  ///< of the set
  std::string group;      ///< planning group; may be empty
  ForeignState start;
  std::vector<ForeignGoal> goals;  ///< any of them counts, the first before others
  std::vector<ForeignAttached> attached = {};
  std::vector<ForeignDetached> detached = {};  ///< of what the world has in the robot's hand
  bool keeps_attached = true;  ///< what the world has in the robot's hand is there, but for `detached`
};

/// What a foreign file holds, and one sentence for each thing that stays behind.
struct ForeignSet {
  std::vector<ForeignWorld> worlds;
  std::vector<ForeignProblem> problems;
  std::vector<std::string> left_out;
};

/// A cone with the tip up, along z about its middle: the pyramid of 64 sides about it, which is at most
/// 0.13 % of the radius larger.
Shape cone_shape(double radius, double height);

/// The surface a x + b y + c z + d = 0, as far as a square that reaches so far from the point nearest to
/// `center`, a hair on the side where the sum is negative, which is the blocked one: so a floor at z = 0
/// takes the voxels below. A solid of kind "plane", in small triangles. Empty for a = b = c = 0.
/// @param center in the plane's frame, metres
std::vector<Eigen::Vector3d> plane_triangles(const Eigen::Vector4d& plane, const Eigen::Vector3d& center,
                                             double reach);

/// "a unit quaternion x, y, z, w, got one of norm 1.4", unless its length is within 1 % of 1: then empty.
/// @param order as the file has its numbers
std::string unit_fault(const Eigen::Vector4d& quaternion, const std::string& order);

/// The pose of a position and a quaternion x, y, z, w. @throws std::invalid_argument "expected a unit
/// quaternion …" unless its length is within 1 % of 1; all zeros mean no turn, as MoveIt has it.
Eigen::Isometry3d pose_of_quaternion(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw);

}  // namespace clearway
