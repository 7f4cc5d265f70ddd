#include "mapping/maps/map_damage.hpp"

#include "mapping/maps/hand_edit.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

std::string damage_caveat(const Snapshot& map) {
  const auto records = map.tree().records_before_damage();
  if (!records) return {};
  return "the map was made from a damaged recording: " + std::to_string(*records) +
         (*records == 1 ? " record of it was" : " records of it were") +
         " read, what is damaged or came after it is missing";
}

std::string contradiction_caveat(const Snapshot& map) {
  constexpr double most_called_free = 0.1;
  constexpr std::uint64_t fewest_looks = 1000;
  const ScanAgreement& agreement = map.tree().agreement();
  if (agreement.looked_up < fewest_looks || agreement.share_called_free() <= most_called_free) return {};
  return short_text(100.0 * agreement.share_called_free(), 2) +
         " % of what its scans hit others had seen free, as where poses, times or calibration are wrong, "
         "or rays meet surfaces at a slant and far apart";
}

std::string map_caveat(const Snapshot& map) {
  std::string all;
  for (const std::string& part :
       {integration_caveat(map), damage_caveat(map), contradiction_caveat(map), hand_edit_caveat(map)})
    all += (all.empty() || part.empty() ? "" : "; ") + part;
  return all;
}

}  // namespace clearway
