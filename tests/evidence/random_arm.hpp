#pragma once

#include <string>

#include "tests/worlds/random_world.hpp"

namespace clearway::evidence {

/// A URDF that nobody tuned anything for: a chain of `joints` turning, sliding or endless joints about any
/// axes, links of boxes, cylinders and spheres, now and then a finger that copies another joint, of its kind
/// or of the other.
std::string random_arm_urdf(Random& random, int joints);

}  // namespace clearway::evidence
