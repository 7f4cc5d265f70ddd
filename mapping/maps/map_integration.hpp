#pragma once

#include <string>

#include "mapping/voxels/integration.hpp"

namespace clearway {

class Snapshot;

MapIntegration integration_of(const Snapshot& map);

/// What a verdict that rests on this map must say about its integration, one sentence; empty when there is
/// nothing to say: made by safe integration, or no scan and no foreign free space in it.
std::string integration_caveat(const Snapshot& map);

}  // namespace clearway
