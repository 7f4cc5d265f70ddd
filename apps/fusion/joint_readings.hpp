#pragma once

#include <optional>
#include <string>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Whether a joint can be at a value, rad or m: at most a whole turn beyond its limits (turns that encoders
/// count on are no fault), or for one that slides within 1 m or ten times its way. Others are in other units.
/// Limits may be narrower than the joint's own, for planning.
bool is_possible(const Joint& joint, double value);

/// Refuses a value at which a joint cannot be (is_possible).
/// @param where the value is from, as a sentence begins
/// @throws std::invalid_argument "<where>: joint 'elbow' reads -90 rad, its limits are -3.14 and 3.14 rad: …"
void require_possible(const Joint& joint, double value, const std::string& where);

/// The clause that says how far a value is beyond the joint's limits, whole turns aside, by more than 0.1 rad
/// or 0.02 m; nothing: it is not.
std::optional<std::string> beyond_limits(const Joint& joint, double value);

}  // namespace clearway
