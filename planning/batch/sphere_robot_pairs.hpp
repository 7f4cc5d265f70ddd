#pragma once

// Private to sphere_robot: what its bodies may meet.

#include <span>

#include "planning/batch/sphere_robot_build.hpp"

namespace clearway {

/// Lists the pairs of bodies by their frames, and grows the trees of spheres with the pairs of these.
/// @pre frames and spheres are placed, and spheres cover all bodies
void pair_spheres(SphereRobot& robot, const SphereGround& ground, std::span<const BodyPair> pairs);

}  // namespace clearway
