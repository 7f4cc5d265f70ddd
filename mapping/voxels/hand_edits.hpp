#pragma once

#include <cstdint>

namespace clearway {

/// How many voxels of a map changed because somebody said what is there, and no sensor did.
struct HandEdits {
  std::uint64_t occupied = 0;  ///< became occupied
  std::uint64_t freed = 0;     ///< became free: occupied or never observed before

  void add(const HandEdits& other) {
    occupied += other.occupied;
    freed += other.freed;
  }
  bool operator==(const HandEdits&) const = default;
};

}  // namespace clearway
