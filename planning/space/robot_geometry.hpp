#pragma once

// Not part of the installed library.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "planning/robot/robot.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/space/body_collision.hpp"

namespace clearway {

/// What a ConfigurationSpace knows of its robot alone, whatever the map.
struct RobotGeometry {
  /// A body that some joint moves, or that hangs on one that is held.
  struct Policed {
    int index = 0;  ///< in the robot's bodies
    std::shared_ptr<const BodyGeometry> geometry;
    Eigen::AlignedBox3d reach;  ///< map frame
    Eigen::VectorXd levers;     ///< metres any point moves at most per unit of each joint
    Eigen::VectorXd turns;      ///< radians any link below the body turns per unit of each joint
  };

  Robot given;
  Robot robot;  ///< the same without_axisymmetric_joints but where that hides a contact
  std::vector<Policed> policed;
  std::vector<BodyPair> pairs;
  Eigen::VectorXd matters;  ///< of each joint 1 when it moves a body, or a pair of them, else 0
};

/// Made once for robots that are the same, as long as few others are asked for.
/// @throws std::invalid_argument for a joint that slides without limits below joints that turn
std::shared_ptr<const RobotGeometry> robot_geometry(const Robot& robot);

}  // namespace clearway
