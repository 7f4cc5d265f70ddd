#pragma once

// What the C++ on the pages takes as known; compiled, never linked.

#include "planning/beam/beam.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"

using namespace clearway;

extern const Snapshot map;
extern const Configuration start, goal;
