#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace clearway {

/// What the map says of one voxel. The table in mapping/README.md gives the exact meaning.
enum class VoxelState : std::uint8_t { unknown, seen_free, painted, occupied, conflict };

/// What a robot part must lie in.
///  painted:      inside its own painted volume (CFV), and not occupied
///  known_free:   painted or seen free by a sensor
///  not_occupied: anything but occupied; unknown counts as free only here
enum class Policy : std::uint8_t { painted, known_free, not_occupied };

/// A policy, for `painted` the painted volumes (bit i = volume i) that count, and for `known_free` how long a
/// look counts.
struct Requirement {
  Policy policy = Policy::not_occupied;
  std::uint16_t volumes = 0xffff;
  /// Seconds before the map's newest look: under `known_free` a voxel that is free only because it was seen
  /// counts as unknown when it was not seen since. Paint does not age, nor does what blocks:
  /// maps refuse an age under the other policies. 0: ever.
  double seen_within = 0.0;

  friend bool operator==(const Requirement&, const Requirement&) = default;
};

/// True when a voxel in `state`, painted by the volumes in `mask`, may hold a part with `requirement`.
/// A conflict (occupied and painted) is allowed under no policy. Whatever `seen_within` says: only a
/// map knows when a voxel was seen (Snapshot::last_seen).
bool allows(const Requirement& requirement, VoxelState state, std::uint16_t mask);

std::string_view to_string(VoxelState state);
std::string_view to_string(Policy policy);

/// Parses "painted", "known_free" or "not_occupied".
/// @throws std::invalid_argument naming the three words.
Policy parse_policy(std::string_view text);

}  // namespace clearway
