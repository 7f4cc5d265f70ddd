#pragma once

#include "planning/robot/robot.hpp"

namespace clearway::bench {

// The built-in Panda again, as robots of other people come: written as URDF and STL files into a folder of
// their own, and loaded from there.

/// Each link that a joint moves filled by spheres along its bodies, so many in all, which stand out of them
/// as little as they can (a published Panda of spheres has 59). The foot stays a box.
Robot panda_of_spheres(int spheres);

/// One mesh a link, the hull of its bodies, with some 200 corners where they are round.
Robot panda_of_meshes();

}  // namespace clearway::bench
