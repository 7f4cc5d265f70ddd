#pragma once

#include <string>

#include "planning/problem/planner.hpp"

namespace clearway {

/// A part whose painted volume lies in several pieces that do not overlap, and that starts in one and has its
/// goal in another: one sentence; empty when there is none. No path exists then, since a part crosses from
/// sphere to sphere only where they overlap. Start and goal must be free. Empty, too, once out of time.
std::string parted_volume_sentence(const PlanProblem& problem);

}  // namespace clearway
