#pragma once

#include <string>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Of the robot's joints, in the order of configurations.
inline std::vector<std::string> joint_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  return names;
}

}  // namespace clearway
