#pragma once

#include <algorithm>

#include "mapping/voxels/integration.hpp"

namespace clearway {

/// What one look of a scan does to the log-odds of one voxel. `compatible` is OctoMap's: log-odds are added
/// and clamped. In `safe` integration what a scan hit is blocked at once, whatever the past said, and the
/// past is forgotten faster where nothing is near:
///   a hit starts from the occupancy threshold when the voxel stands below it;
///   a clear look (see ScanTile::clear) halves what the voxel stands above the threshold, when that is more
///   than a miss takes.
/// With OctoMap's probabilities one hit of a free voxel is gone after three looks, clear or not, and what was
/// hit any number of times after five clear ones (nine that are not).
struct OccupancyUpdate {
  Integration integration;
  float hit, miss;  ///< log-odds of the sensor model; miss <= 0 <= hit
  float low, high;  ///< clamping
  float threshold;  ///< at and over it an observed voxel is occupied; in [low, high]

  float after_hit(float log_odds) const {
    return clamped((integration == Integration::safe ? std::max(log_odds, threshold) : log_odds) + hit);
  }
  float after_miss(float log_odds) const { return clamped(log_odds + miss); }
  float after_clear_look(float log_odds) const {
    const float value = std::min(log_odds, high);  // a foreign map's may stand higher
    return clamped(value - std::max(-miss, 0.5F * (value - threshold)));
  }
  /// True when a clear look differs from a miss for this voxel.
  bool distinguishes_clear_looks(float log_odds) const {
    return integration == Integration::safe && log_odds > threshold;
  }

 private:
  float clamped(float log_odds) const {  // as OctoMap clamps: low first
    if (log_odds < low) log_odds = low;
    if (log_odds > high) log_odds = high;
    return log_odds;
  }
};

}  // namespace clearway
