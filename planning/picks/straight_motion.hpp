#pragma once

#include <optional>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Configurations that lead the tip straight on, its attitude kept, at most `step` apart: the first is
/// `from`, the last has the tip moved by `way` (metres, map frame). None where the arm cannot without
/// changing its configuration, or a joint would jump.
std::optional<std::vector<Configuration>> straight_motion(const Robot& robot, const Configuration& from,
                                                          const Eigen::Vector3d& way, double step);

/// Whether all edges of a path are free.
bool is_path_free(const ConfigurationSpace& space, const std::vector<Configuration>& path);

/// Whether the lowest point of the robot's body is from `low` to `high` (metres, map frame) all along the
/// path: by bisection, each piece proved by how far the body can move on it. False where it cannot be proved.
bool keeps_height(const Robot& robot, std::size_t body, const std::vector<Configuration>& path, double low,
                  double high);

}  // namespace clearway
