#include "mapping/maps/map_difference.hpp"

#include <algorithm>

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/leaf_pairs.hpp"

namespace clearway {
namespace {

bool same_spheres(const PaintedVolume& a, const PaintedVolume& b) {
  const auto same = [](const Sphere& x, const Sphere& y) {
    return x.center == y.center && x.radius == y.radius;
  };
  return std::equal(a.spheres.begin(), a.spheres.end(), b.spheres.begin(), b.spheres.end(), same);
}

const PaintedVolume* with_label(const std::vector<PaintedVolume>& volumes, const std::string& label) {
  const auto found =
      std::find_if(volumes.begin(), volumes.end(), [&](const auto& volume) { return volume.label == label; });
  return found == volumes.end() ? nullptr : &*found;
}

std::vector<std::string> different_volumes(const std::vector<PaintedVolume>& mine,
                                           const std::vector<PaintedVolume>& theirs) {
  std::vector<std::string> labels;
  for (const PaintedVolume& volume : mine) {
    const PaintedVolume* other = with_label(theirs, volume.label);
    if (other == nullptr || other->critical_parts != volume.critical_parts || !same_spheres(volume, *other))
      labels.push_back(volume.label);
  }
  for (const PaintedVolume& volume : theirs) {
    if (with_label(mine, volume.label) == nullptr) labels.push_back(volume.label);
  }
  return labels;
}

/// The other map's masks in numbers of this map's volumes; those it does not have get bits of their own.
std::vector<unsigned> bits_here(const std::vector<PaintedVolume>& mine,
                                const std::vector<PaintedVolume>& theirs) {
  std::vector<unsigned> bits;
  for (unsigned v = 0; v < 16; ++v) {
    const PaintedVolume* here = v < theirs.size() ? with_label(mine, theirs[v].label) : nullptr;
    const bool bare = theirs.empty() && mine.empty();
    bits.push_back(here != nullptr ? 1U << (here - mine.data()) : bare ? 1U << v : 0x10000U << v);
  }
  return bits;
}

}  // namespace

MapDifference difference(const Snapshot& map, const Snapshot& other) {
  MapDifference result;
  const FusedTree &mine = map.tree(), &theirs = other.tree();
  result.resolution = map.resolution() != other.resolution();
  result.threshold = mine.getOccupancyThresLog() != theirs.getOccupancyThresLog();
  result.volumes = different_volumes(map.volumes(), other.volumes());
  if (result.resolution) return result;
  const std::vector<unsigned> bits = bits_here(map.volumes(), other.volumes());
  const FusedNode nothing;
  visit_leaf_pairs(mine, theirs, [&](const FusedNode* a, const FusedNode* b, const CellCube& cube) {
    const FusedNode &here = a != nullptr ? *a : nothing, &there = b != nullptr ? *b : nothing;
    const VoxelState first = mine.state(here), second = theirs.state(there);
    if (first != second) {
      result.states[{first, second}] += cube.volume();
      return;
    }
    unsigned mask = 0;
    for (unsigned v = 0; v < 16; ++v) mask |= (there.painted() >> v & 1U) != 0 ? bits[v] : 0U;
    const bool same = here.observed() == there.observed() && here.painted() == mask &&
                      (!here.observed() || here.getLogOdds() == there.getLogOdds());
    if (!same) result.evidence += cube.volume();
  });
  return result;
}

}  // namespace clearway
