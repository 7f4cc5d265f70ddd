#pragma once

#include <string>
#include <vector>

#include "apps/teach/teach_event.hpp"
#include "datasets/descriptions/setup.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

/// A configuration that a person picked, and what the hand held then: that rides on the leg that ends there.
struct TaughtPlace {
  Configuration q;
  std::vector<Load> held;
};

/// The load of an `attach`: its own, or the setup's of that name. @throws std::invalid_argument for a name
/// that the setup does not have (naming the nearest one), and as leg_load does.
Load load_of(const TeachEvent& event, const Setup& setup);

/// The same loads in the same order.
bool are_same(const std::vector<Load>& a, const std::vector<Load>& b);

bool holds(const std::vector<Load>& held, const std::string& name);

/// What rides on the legs that end at these places, each load once; leg i ends at ends[i].
/// @pre loads of one name are the same
std::vector<LegLoad> loads_of_legs(const std::vector<TaughtPlace>& ends);

/// What is held, for a sentence: "'can'", "'can' and 'lid'"; "nothing".
std::string names_of(const std::vector<Load>& held);

}  // namespace clearway
