#pragma once

#include <cstdint>

namespace clearway {

/// How many voxels of a map changed because somebody said what is there, and no sensor did.
struct HandEdits {
  std::uint64_t occupied = 0;  ///< became occupied
  std::uint64_t freed = 0;     ///< became free: occupied or never observed before
  std::uint64_t cut = 0;       ///< were occupied until a crop cut them off

  void add(const HandEdits& other) {
    occupied += other.occupied;
    freed += other.freed;
    cut += other.cut;
  }
  bool operator==(const HandEdits&) const = default;
};

}  // namespace clearway
