#pragma once

#include <string>
#include <vector>

#include "mapping/voxels/sphere.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// The hand that generators paint for: a robot's critical parts, or what is on its tip's link when it has
/// none.
class SuiteHand {
 public:
  /// Keeps a reference to the robot. @param kind of generator, for the message
  /// @throws std::runtime_error for a robot without such a body
  SuiteHand(const Robot& robot, const std::string& kind);

  /// A sphere about all of it.
  Sphere sphere(const Configuration& q) const;

 private:
  static Eigen::Vector3d center(const Body& body, const LinkPoses& poses);

  const Robot& robot_;
  std::vector<const Body*> bodies_;
};

/// How a hand stands at an arm's tip.
struct HandAtTip {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, the tip's frame: the way that it points
  double depth = 0.0;                               ///< m that it reaches beyond the tip that way
};

/// It points along the tip's z; where that is more than 45 degrees off the axis of the last joint, before
/// which the tip stands, along that axis, as on flanges whose x is ahead. What hangs on the tip's link
/// reaches as deep.
HandAtTip hand_at_tip(const Robot& robot);

/// A straight piece of a way, cut so that no joint moves by more than `step`; both ends included.
std::vector<Configuration> finely(const Configuration& from, const Configuration& to, double step);

}  // namespace clearway
