#pragma once

#include "planning/robot/robot.hpp"

namespace clearway {

/// The joint's limit, where the value is beyond it by no more than rounding: by the 4e-7 of it that two
/// roundings to single precision may take, or by 1e-9, and at most by 1e-6 rad or m. Else the value.
double drawn_to_limit(const Joint& joint, double value);

}  // namespace clearway
