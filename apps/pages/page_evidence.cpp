#include "apps/pages/page_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

constexpr std::uint8_t several_volumes = 255;

/// 1 to 255 for `from` to `to`.
std::uint8_t step_of(double value, double from, double to) {
  const double share = to > from ? std::clamp((value - from) / (to - from), 0.0, 1.0) : 1.0;
  return static_cast<std::uint8_t>(1 + std::lround(254.0 * share));
}

std::uint8_t volume_of(std::uint16_t mask) {
  if (mask == 0) return 0;
  if ((mask & (mask - 1)) != 0) return several_volumes;
  std::uint8_t number = 1;
  while ((mask >>= 1) != 0) ++number;
  return number;
}

/// The grid that holds the map in cubes of 2^k voxels, as fine as most_cells allow.
PageEvidence empty_grid(const MapLeaves& map) {
  PageEvidence grid;
  const Eigen::AlignedBox3d bounds = map.bounds();
  if (bounds.isEmpty()) return grid;
  const Eigen::Vector3i low = (bounds.min() / map.resolution()).array().round().cast<int>();
  const Eigen::Vector3i high = (bounds.max() / map.resolution()).array().round().cast<int>();
  for (;; grid.cell *= 2) {
    for (int a = 0; a < 3; ++a) {
      const int first = static_cast<int>(std::floor(static_cast<double>(low[a]) / grid.cell));
      grid.low[a] = first * grid.cell;
      grid.size[a] = (high[a] - grid.low[a] + grid.cell - 1) / grid.cell;
    }
    if (grid.size.cast<double>().prod() <= static_cast<double>(PageEvidence::most_cells)) break;
  }
  const auto cells = static_cast<std::size_t>(grid.size.prod());
  for (auto* list : {&grid.look, &grid.volume, &grid.low_odds, &grid.high_odds}) list->assign(cells, 0);
  return grid;
}

/// Calls `visit` with the index of each cube that a leaf reaches, and a voxel of the leaf in it.
template <class Visit>
void visit_cubes(const PageEvidence& grid, const MapLeaf& leaf, const Visit& visit) {
  const Eigen::Vector3i first = (leaf.corner - grid.low) / grid.cell;
  const Eigen::Vector3i last =
      (leaf.corner + Eigen::Vector3i::Constant(leaf.edge - 1) - grid.low) / grid.cell;
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const Eigen::Vector3i corner = grid.low + grid.cell * Eigen::Vector3i(x, y, z);
        visit(static_cast<std::size_t>(x + grid.size.x() * (y + grid.size.y() * z)),
              Eigen::Vector3i(corner.cwiseMax(leaf.corner)));
      }
}

}  // namespace

EvidenceGrid::EvidenceGrid(const MapLeaves& map) : seen_(map.about().seen()), grid_(empty_grid(map)) {
  if (seen_ != nullptr && !seen_->empty()) {
    grid_.oldest = seen_->oldest();
    grid_.newest = seen_->newest();
  }
  grid_.least = static_cast<double>(map.about().tree().getClampingThresMinLog());
  grid_.greatest = static_cast<double>(map.about().tree().getClampingThresMaxLog());
  asked_.assign(grid_.look.size(), 0);
}

void EvidenceGrid::add(const MapLeaf& leaf) {
  const std::uint8_t volume = volume_of(leaf.volumes);
  const std::uint8_t odds = leaf.observed ? step_of(leaf.log_odds, grid_.least, grid_.greatest) : 0;
  visit_cubes(grid_, leaf, [&](std::size_t cube, const Eigen::Vector3i& voxel) {
    if (volume != 0) {
      std::uint8_t& known = grid_.volume[cube];
      known = known == 0 || known == volume ? volume : several_volumes;
    }
    if (odds == 0) return;
    grid_.low_odds[cube] = grid_.low_odds[cube] == 0 ? odds : std::min(grid_.low_odds[cube], odds);
    grid_.high_odds[cube] = std::max(grid_.high_odds[cube], odds);
    if (seen_ == nullptr || asked_[cube] == PageEvidence::looks_sampled) return;
    ++asked_[cube];
    if (const auto time = seen_->last_seen(voxel))
      grid_.look[cube] = std::max(grid_.look[cube], step_of(*time, grid_.oldest, grid_.newest));
  });
}

nlohmann::json evidence_json(PageArrays& arrays, const PageEvidence& evidence) {
  const auto place = [&](const std::vector<std::uint8_t>& values) -> nlohmann::json {
    const bool is_empty = std::all_of(values.begin(), values.end(), [](std::uint8_t v) { return v == 0; });
    const std::size_t count = is_empty ? 0 : values.size();
    const ArrayPlace at = arrays.add(std::string_view(reinterpret_cast<const char*>(values.data()), count));
    return {{"type", at.type}, {"offset", at.offset}, {"count", at.count}};
  };
  const auto triple = [](const Eigen::Vector3i& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  return {{"cell", evidence.cell},
          {"low", triple(evidence.low)},
          {"size", triple(evidence.size)},
          {"times", {evidence.oldest, evidence.newest}},
          {"odds", {evidence.least, evidence.greatest}},
          {"look", place(evidence.look)},
          {"volume", place(evidence.volume)},
          {"lowOdds", place(evidence.low_odds)},
          {"highOdds", place(evidence.high_odds)}};
}

}  // namespace clearway
