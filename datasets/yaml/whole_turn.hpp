#pragma once

#include <cmath>
#include <numbers>

namespace clearway {

/// Whether an angle of a pose, radians, is no more than a whole turn: who gives more means degrees.
inline bool is_within_turn(double angle) { return std::abs(angle) <= 2.0 * std::numbers::pi + 1e-3; }

}  // namespace clearway
