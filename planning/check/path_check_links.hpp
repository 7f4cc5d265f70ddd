#pragma once

// Private to path_check: what its kinematics are made of, from a robot in memory or from its file.

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "planning/robot/robot.hpp"

namespace KDL {
class Segment;
}
namespace tinyxml2 {
class XMLElement;
}
namespace urdf {
class ModelInterface;
}

namespace clearway::check {

/// An attribute of a SRDF's element without blanks around it; "" where it lacks.
std::string word_of(const tinyxml2::XMLElement& element, const char* name);

/// A link of Robot::links as KDL sees it.
struct KdlLink {
  std::shared_ptr<const KDL::Segment> segment;
  int parent = -1;  ///< -1 for the root
  int joint = -1;   ///< of the configuration; -1: fixed
  /// Value of its joint = multiplier * q + offset; of one that does not move: offset.
  double multiplier = 1.0, offset = 0.0;
  bool is_held = false;  ///< its joint could move, but stands still
  bool stands = false;   ///< its bodies may touch the map, as Robot::standing says: a wheel on its floor

  double value(const Eigen::VectorXd& q) const { return offset + (joint < 0 ? 0.0 : multiplier * q[joint]); }
};

/// A robot as KDL sees it: its links in the order of Robot::links, and where the bodies are on them.
struct KdlModel {
  std::vector<KdlLink> links;
  std::vector<Eigen::Isometry3d> link_from_body;  ///< of each of Robot::bodies
};

/// The robot is not what its file says it is: the sentence names the link, joint or body.
class FileDisagrees : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @throws FileDisagrees with `what` after the names of the robot and its URDF.
[[noreturn]] void disagree(const Robot& robot, const std::string& what);

/// Whether Robot::standing names the link.
bool stands(const Robot& robot, const std::string& link);

/// From the robot's own links, for robots that were made in memory.
KdlModel model_of_robot(const Robot& robot);

/// From the robot's URDF at the robot's scale, read by urdfdom and kdl_parser. Nothing of the robot is used
/// but the names and the order of its links, joints and bodies.
/// @throws FileDisagrees for links, joints, limits or bodies that are not those of the robot;
/// std::invalid_argument when the file can no longer be read.
KdlModel model_of_file(const Robot& robot);

/// How many of the robot's links and bodies are its own: its loads' come last.
std::size_t own_links(const Robot& robot);
std::size_t own_bodies(const Robot& robot);

/// The robot with its loads as Robot::loads states them, whatever its bodies say.
/// @throws FileDisagrees unless a link and a body of each load's name come last, in order, on the link that
/// it names.
Robot with_stated_loads(const Robot& robot);

/// Adds a fixed link and a body for each load, from Robot::loads alone.
void add_loads(const Robot& robot, KdlModel& model);

/// Whether two bodies may touch because one is a load and the other what holds it; none: neither is a load.
std::optional<bool> is_held(const Robot& robot, std::size_t a, std::size_t b);

/// The joints of the robot's planning group that move in its URDF and mimic none, read from its SRDF again.
/// @throws FileDisagrees when there is no such group.
std::set<std::string> group_of_file(const Robot& robot, const urdf::ModelInterface& model);

}  // namespace clearway::check
