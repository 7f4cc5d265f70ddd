#pragma once

// Not part of the installed library.

#include "planning/robot/robot.hpp"

namespace clearway {

/// Whether all that determines where the robots' bodies can be, and which of them may touch, is the same to
/// the last bit: joints, links, bodies with their covers, and where they stand.
bool is_same(const Robot& a, const Robot& b);

}  // namespace clearway
