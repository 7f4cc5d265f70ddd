#include "mapping/maps/map_damage.hpp"

#include <cmath>
#include <initializer_list>

#include "mapping/maps/hand_edit.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/input_file.hpp"
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

namespace {

constexpr std::uint64_t fewest_looks = 300;

/// Whether so many of all are more than this share by the lower end of Wilson's interval at 95 %.
bool are_more_than(double share, std::uint64_t some, std::uint64_t all) {
  if (all < fewest_looks) return false;
  constexpr double z = 1.96;
  const double n = static_cast<double>(all), p = static_cast<double>(some) / n;
  const double middle = p + z * z / (2.0 * n);
  const double reach = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return (middle - reach) / (1.0 + z * z / n) > share;
}

std::string percent_of(std::uint64_t some, std::uint64_t all) {
  return short_text(100.0 * static_cast<double>(some) / static_cast<double>(all), 2);
}

}  // namespace

std::string contradiction_caveat(const Snapshot& map) {
  constexpr double most_in_stable = 0.1, most_anywhere = 0.2;
  const ScanAgreement& agreement = map.tree().agreement();
  const std::uint64_t free = agreement.called_free + agreement.amid_free,
                      known = agreement.looked_up + agreement.amid_free;
  if (are_more_than(most_anywhere, free, known))
    return percent_of(free, known) +
           " % of what its scans hit others had seen free, as where poses, axes, units or calibration are "
           "wrong, or much moves";
  if (are_more_than(most_in_stable, agreement.called_free, agreement.looked_up))
    return percent_of(agreement.called_free, agreement.looked_up) +
           " % of what its scans hit others had seen free, as where poses, times or calibration are wrong, "
           "or rays meet surfaces at a slant and far apart";
  return {};
}

namespace {

std::string joined(std::initializer_list<std::string> parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() || part.empty() ? "" : "; ") + part;
  return all;
}

}  // namespace

std::string unsaid_in_export(const Snapshot& map, const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  if (kind != ".ot" && kind != ".bt") return map_caveat(map);
  const bool is_compatible = integration_of(map) == MapIntegration::compatible;
  return joined({is_compatible ? integration_caveat(map) : "", contradiction_caveat(map)});
}

std::string map_caveat(const Snapshot& map) {
  return joined(
      {integration_caveat(map), damage_caveat(map), contradiction_caveat(map), hand_edit_caveat(map)});
}

}  // namespace clearway
