#pragma once

#include <string>

#include "apps/python/bindings.hpp"
#include "planning/files/plan_file.hpp"

namespace clearway {

/// A plan answers for one robot at one place. @param whose word for what the robot is of: "space", "robot"
/// @throws std::invalid_argument where the plan's joints, name, scale, base or held joints are not the
/// robot's
void require_own_robot(const Robot& robot, const std::string& asked, const Plan& plan,
                       const std::string& whose);

/// The robot where the plan has its base, as `clearway` takes it from the plan: one that nobody placed stands
/// at the map's origin. One that is placed stays where it is.
Robot placed_by(const Plan& plan, Robot robot);

/// As `clearway check` does: by the digest of the map, which it has without a file, too. A plan that names no
/// map is told apart by its resolution alone. @throws std::invalid_argument for a plan that was made on
/// another map
void require_own_map(const NamedSpace& space, const Plan& plan);

/// Its robot, map (unless another is accepted) and terms. @throws std::invalid_argument also for a space
/// whose policies, padding or age of evidence ask less than the plan's
void require_own_space(const NamedSpace& space, const Plan& plan, bool accept_map);

}  // namespace clearway
