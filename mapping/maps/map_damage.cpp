#include "mapping/maps/map_damage.hpp"

#include "mapping/maps/hand_edit.hpp"
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
  std::string all;
  for (const std::string& part : {integration_caveat(map), damage_caveat(map), hand_edit_caveat(map)})
    all += (all.empty() || part.empty() ? "" : "; ") + part;
  return all;
}

}  // namespace clearway
