#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "apps/pages/page_arrays.hpp"
#include "mapping/files/map_leaves.hpp"

namespace clearway {

class SeenStamps;

/// What a map knows of its voxels beside their states, in a grid of cubes: single voxels where these are few,
/// else coarser. All lists have a value for each cube, x fastest; 0 stands for nothing known.
struct PageEvidence {
  static constexpr std::size_t most_cells = std::size_t{1} << 20U;
  static constexpr int looks_sampled = 8;  ///< leaves of a cube whose look times are asked for

  int cell = 1;                                    ///< voxels along a cube's edge
  Eigen::Vector3i low = Eigen::Vector3i::Zero();   ///< lowest voxel of the grid, from the map's origin
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  ///< cubes along each axis; zero: no voxels
  double oldest = 0.0, newest = 0.0;               ///< look times that 1 and 255 stand for, s
  double least = 0.0, greatest = 0.0;              ///< log-odds that 1 and 255 stand for: the map's limits
  std::vector<std::uint8_t> look;                  ///< the newest of the voxels, 8 of a cube asked at most
  std::vector<std::uint8_t> volume;                ///< 1 + the painted volume; 255: several
  std::vector<std::uint8_t> low_odds;              ///< least log-odds of the observed voxels
  std::vector<std::uint8_t> high_odds;             ///< the greatest
};

/// Gathers it leaf by leaf. Memory: most_cells times a few bytes.
class EvidenceGrid {
 public:
  /// @param map whose bounds the grid takes; outlives this object
  explicit EvidenceGrid(const MapLeaves& map);
  void add(const MapLeaf& leaf);
  PageEvidence take() { return std::move(grid_); }

 private:
  const SeenStamps* seen_;
  PageEvidence grid_;
  std::vector<std::uint8_t> asked_;  ///< look times of each cube
};

/// For the page: see Evidence in apps/viewer/src/data.ts.
nlohmann::json evidence_json(PageArrays& arrays, const PageEvidence& evidence);

}  // namespace clearway
