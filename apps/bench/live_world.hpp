#pragma once

#include <vector>

#include "apps/bench/live_loop.hpp"
#include "apps/bench/worlds/live_room.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {

/// An arm in a room that was seen before its loop starts, what the loop does, and the frames that come.
struct LiveWorld {
  Robot robot;
  FreeSpaceMap map;
  LoopTask task;
  std::vector<LiveFrame> frames;

  ConfigurationSpace space(Snapshot seen) const {
    return {robot, std::move(seen), {.critical_by_default = false}};
  }
};

/// The arm is near something, and five places for the fist are beside it: seen by the camera, in free space,
/// and wherever the arm is on its way their visible side is within reach of its constraints, but not in its
/// way.
LiveWorld make_live_world(double resolution, double influence);

}  // namespace clearway::bench
