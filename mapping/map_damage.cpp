#include "mapping/map_damage.hpp"

#include "mapping/fused_tree.hpp"

namespace clearway {

std::string damage_caveat(const Snapshot& map) {
  const auto records = map.tree().records_before_damage();
  if (!records) return {};
  return "the map was made from a damaged recording: " + std::to_string(*records) +
         (*records == 1 ? " record of it was" : " records of it were") + " read, what came after is missing";
}

}  // namespace clearway
