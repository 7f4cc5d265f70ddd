#pragma once

#include <string>

#include "mapping/snapshot.hpp"

namespace clearway {

/// "the map was made from a damaged recording: 37 records of it were read, what came after them is missing";
/// empty for any other map. Known of maps in our own .ot files and of what is made of them.
std::string damage_caveat(const Snapshot& map);

/// What a verdict that rests on this map must say of it, a sentence each: how it was integrated
/// (integration_caveat), damage, and changes by hand (hand_edit_caveat). Empty when there is nothing to say.
std::string map_caveat(const Snapshot& map);

}  // namespace clearway
