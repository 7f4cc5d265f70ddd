#pragma once

#include <string>

namespace clearway {

/// A disc that slides round a thin wall, and an arm of two joints in free space. What looks at edges far
/// apart goes straight through the wall.
inline const std::string small_suite = R"(
title: A wall and a <swing>
seed: 3
time_limit: 20
worlds:
  - name: wall
    resolution: 0.05
    solids:
      - {name: wall, box: [0.06, 2.4, 0.3], pose: [1.02, -0.7, 0, 0, 0, 0]}
    sensors: [[0, 0, 0.02], [2.5, -0.5, 0.02]]
    sensor_range: 2.2
experiments:
  - name: round
    title: Round a wall
    paper: What a paper says.
    notes: What we say.
    robot: point
    world: wall
    problems:
      - {name: there, start: [0.2, 0], goals: [[2, 0]]}
      - {name: there and back, start: [0.2, 0], goals: [[2, 0], [0.2, -0.5]]}
      - {name: blocked, start: [1.02, -0.5], goals: [[2, 0]]}
    policies: {default: not_occupied}
    planners:
      - {planner: beam, label: "beam, k = 1", options: {width: 1, step: 0.05}}
      - {planner: beam, label: beam k=10, options: {width: 10, step: 0.05}}
      - {planner: rrtconnect}
      - {planner: rrtconnect_fcl, label: coarse, options: {resolution: 0.5}}
    runs: 2
    plots: [profiles, cost_against_width, share_against_width]
  - name: swing
    robot: planar2
    world: wall
    problems:
      - {name: swing, start: [2.8, 0.1], goals: [[2.2, 0.4]]}
    policies: {default: not_occupied}
    planners: [{planner: beam}, {planner: rrtconnect}]
)";

}  // namespace clearway
