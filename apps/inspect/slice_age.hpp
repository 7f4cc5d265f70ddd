#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "mapping/snapshot.hpp"

namespace clearway {

/// Colours for what was seen free: from light for the map's newest look to dark for the voxel that was not
/// looked at for longest, evenly in time.
class AgeColours {
 public:
  using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

  static constexpr Colour unknown{228, 200, 232};  ///< seen, but at a time that the map does not know

  /// @throws std::invalid_argument for a map that does not know when its voxels were seen.
  explicit AgeColours(const Snapshot& map);

  double greatest_age() const { return greatest_age_; }  ///< seconds before the newest look
  /// Of an age in [0, greatest_age()], seconds.
  Colour of_age(double age) const;
  /// Of a voxel that was last seen at a time (Snapshot::last_seen).
  Colour of(std::optional<double> last_seen) const;

 private:
  double newest_, greatest_age_;
};

}  // namespace clearway
