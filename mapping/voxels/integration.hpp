#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace clearway {

/// What a scan's rays may free, and what its hits block.
enum class Integration {
  compatible,  ///< as OctoMap: frees every voxel that a ray passes and no ray of the scan ends in; adds
               ///< log-odds
  safe,        ///< frees less: nothing beside a surface, nothing within the noise of the range (SafeMargins);
               ///< what it hits is blocked at once (OccupancyUpdate)
};

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

}  // namespace clearway
