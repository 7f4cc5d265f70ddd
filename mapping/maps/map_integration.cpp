#include "mapping/maps/map_integration.hpp"

#include "mapping/snapshot.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

MapIntegration integration_of(const Snapshot& map) { return map.tree().integration(); }

std::string integration_caveat(const Snapshot& map) {
  switch (integration_of(map)) {
    case MapIntegration::compatible:
      return "the map was made by compatible integration (OctoMap's): rays that graze a surface may have "
             "freed it, and what came where space was seen free for long is blocked only after its third hit";
    case MapIntegration::unknown:
      if (!map.holds_any({VoxelState::seen_free})) return {};
      return "which integration made the map's free space is not known (a foreign or older file): surfaces "
             "may have been freed, and what came last may not be blocked";
    default:
      return {};
  }
}

}  // namespace clearway
