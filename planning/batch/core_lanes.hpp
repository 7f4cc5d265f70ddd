#pragma once

// Not part of the installed library.

#include "mapping/system/instruction_set.hpp"
#include "planning/batch/piece_lanes.hpp"

namespace clearway {

/// Of the lanes that are active those in which the robot in the middle of the piece surely touches what
/// blocks it, by few spheres that lie inside of its bodies: quick, and most of what is blocked. Places the
/// frames, which look() then need not. The same on every machine.
/// @param enough whether some of these lanes are found is all that is asked: others may be missing then
PieceLanes::Lanes touching_lanes(const SphereRobot& robot, PieceLanes& lanes, PieceLanes::Lanes enough);
/// The same with the given instruction set, which the machine must support.
PieceLanes::Lanes touching_lanes(const SphereRobot& robot, PieceLanes& lanes, PieceLanes::Lanes enough,
                                 InstructionSet vectors);

}  // namespace clearway
