#pragma once

#include <cstddef>
#include <vector>

#include "apps/suites/suite_stages.hpp"

namespace clearway {

constexpr std::size_t problems_of_a_shelf = 10;

/// An open room with a shelf before the arm, as three sensors see it, and queries from one compartment to
/// another.
struct Shelf {
  SuiteWorld world;  ///< solids and sensors
  Snapshot map;      ///< what the sensors saw of it
  std::vector<StageProblem> problems;
};

/// Draws shelf number `index` of a generator, with `problems_of_a_shelf` problems (the last shelf with what
/// is left of the generator's count). Lengths are for an arm of about 1 m reach whose shoulder is 0.7 m over
/// its base, such as the PUMA 560, and go with the robot's scale. Start and goal hold the tip in two
/// different compartments, looking in (its z axis at most 35 degrees off), both are free, the goal's arm
/// configuration is that of the start, and the straight edge between them is not free.
/// @param padding metres
/// @throws std::runtime_error when 20,000 draws hold no such problem.
Shelf draw_shelf(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                 const Policies& policies, double padding);

}  // namespace clearway
