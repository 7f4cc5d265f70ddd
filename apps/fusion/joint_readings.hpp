#pragma once

#include <optional>
#include <string>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Refuses a value, rad or m, at which a joint cannot be: more than a whole turn beyond its limits, or for
/// one that slides more than its way and 0.1 m. It is in other units then. Turns that encoders count on are
/// no fault.
/// @param where the value is from, as a sentence begins
/// @throws std::invalid_argument "<where>: joint 'elbow' reads -90 rad, its limits are -3.14 and 3.14 rad: …"
void require_possible(const Joint& joint, double value, const std::string& where);

/// The clause that says how far a value is beyond the joint's limits, whole turns aside, by more than 0.1 rad
/// or 0.02 m; nothing: it is not. Limits may be narrower than the joint's own, for planning.
std::optional<std::string> beyond_limits(const Joint& joint, double value);

}  // namespace clearway
