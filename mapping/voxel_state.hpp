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

/// A policy, and for `painted` the painted volumes (bit i = volume i) that count.
struct Requirement {
  Policy policy = Policy::not_occupied;
  std::uint16_t volumes = 0xffff;

  friend bool operator==(const Requirement&, const Requirement&) = default;
};

/// True when a voxel in `state`, painted by the volumes in `mask`, may hold a part with `requirement`.
/// A conflict (occupied and painted) is allowed under no policy.
bool allows(const Requirement& requirement, VoxelState state, std::uint16_t mask);

std::string_view to_string(VoxelState state);
std::string_view to_string(Policy policy);

/// Parses "painted", "known_free" or "not_occupied".
/// @throws std::invalid_argument naming the three words.
Policy parse_policy(std::string_view text);

}  // namespace clearway
