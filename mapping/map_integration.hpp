#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "mapping/safe_margins.hpp"

namespace clearway {

class Snapshot;

/// Which integration put into a map what sensors saw. In order: of a map that was made of two, the later one
/// holds.
enum class MapIntegration : std::uint8_t {
  none,        ///< no scan: paint alone, or a cloud of obstacles
  safe,        ///< Integration::safe, and nothing else
  unknown,     ///< a foreign file, or one of ours that does not say
  compatible,  ///< Integration::compatible had a part in it
};

constexpr const char* to_string(MapIntegration integration) {
  constexpr const char* names[] = {"none", "safe", "unknown", "compatible"};
  return names[static_cast<std::size_t>(integration)];
}

constexpr MapIntegration map_integration(Integration integration) {
  return integration == Integration::safe ? MapIntegration::safe : MapIntegration::compatible;
}

/// Of a map that two parts went into.
constexpr MapIntegration of_both(MapIntegration a, MapIntegration b) { return std::max(a, b); }

MapIntegration integration_of(const Snapshot& map);

/// What a verdict that rests on this map must say about its integration, one sentence; empty when there is
/// nothing to say: made by safe integration, or no scan and no foreign free space in it.
std::string integration_caveat(const Snapshot& map);

}  // namespace clearway
