#include "mapping/maps/map_damage.hpp"

#include "mapping/maps/map_integration.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

std::string damage_caveat(const Snapshot& map) {
  const auto records = map.tree().records_before_damage();
  if (!records) return {};
  return "the map was made from a damaged recording: " + std::to_string(*records) +
         (*records == 1 ? " record of it was" : " records of it were") + " read, what came after is missing";
}

std::string map_caveat(const Snapshot& map) {
  const std::string integration = integration_caveat(map), damage = damage_caveat(map);
  return integration + (integration.empty() || damage.empty() ? "" : "; ") + damage;
}

}  // namespace clearway
