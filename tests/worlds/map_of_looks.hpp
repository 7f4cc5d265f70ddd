#pragma once

#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::worlds {

constexpr double looked_at_edge = 0.05;  ///< m, of its voxels

/// What a map knows that was seen free all round points, some 0.6 m far, each at its time; the newest look,
/// far from there, is of 15 s.
inline Snapshot map_of_looks(const std::vector<std::pair<Eigen::Vector3d, double>>& looks) {
  FreeSpaceMap builder({.resolution = looked_at_edge, .integration = Integration::compatible});
  Random random(11);
  for (const auto& [point, time] : looks) {
    Scan all_round;
    all_round.map_from_sensor.translation() = point;
    all_round.time = time;
    for (int k = 0; k < 20'000; ++k)
      all_round.clear_to.push_back((0.6 * random.point(1.0).normalized()).cast<float>());
    builder.insert(all_round);
  }
  Scan elsewhere;
  elsewhere.map_from_sensor.translation().setConstant(9.0);
  elsewhere.time = 15.0;
  elsewhere.points = {{0.5F, 0.0F, 0.0F}};
  builder.insert(elsewhere);
  return builder.snapshot();
}

}  // namespace clearway::worlds
