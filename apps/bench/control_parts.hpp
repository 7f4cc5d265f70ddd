#pragma once

#include "apps/bench/bench.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway::bench {

constexpr double step_limit = 0.01;  ///< of each joint, radians

/// This thread's CPU time, us. A call takes some 0.3 us, which are taken off (`clock_us`).
double now_us();
double clock_us();

/// Three arms that stand 0.9 m apart, each with constraints against the map, itself and the bodies of both
/// others.
nlohmann::ordered_json three_arms(const Snapshot& map, const Robot& robot);

/// How much farther than the nearest voxel of all the nearest row of a body is, by exact shapes.
nlohmann::ordered_json against_exact(const ConfigurationSpace& space);

/// Our distance between bodies against the smaller of FCL's two solvers (either alone can be too large).
nlohmann::ordered_json against_fcl(const Robot& robot);

}  // namespace clearway::bench
