#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planning/files/json_field.hpp"
#include "planning/problem/pick.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

// Loads as plan.json and queries.json hold them: {"name", "link", "pose" (4x4), "shape", "mass_kg",
// "touches"} and, of a load that rides on single legs, "legs", from 1.

/// {"sphere": r}, {"capsule": [r, l]}, {"cylinder": [r, l]}, {"box": [x, y, z]} or {"hull": [[x, y, z], …]}.
nlohmann::ordered_json json_of(const Shape& shape);
/// @throws std::invalid_argument naming the field.
Shape shape_of(const JsonField& field);

nlohmann::ordered_json json_of(const std::vector<LegLoad>& loads);
/// @throws std::invalid_argument naming the field. Whether the robot has the links is for with_load to say.
std::vector<LegLoad> loads_of(const JsonField& field);

/// {"name", "link", "shape", "mass_kg", "touches", "pose", "place", "grasp" (4x4), "approach", "lift_m",
/// "contact_m", "margin_m"} and, where the hand closes, "depth_m" and "grip" {joint: [open, closed]}.
nlohmann::ordered_json json_of(const Pick& pick);
/// @throws std::invalid_argument naming the field. Whether it is sound is for require_sound to say.
Pick pick_of(const JsonField& field);

}  // namespace clearway
