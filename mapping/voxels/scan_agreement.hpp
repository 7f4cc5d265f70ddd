#pragma once

#include <cstdint>

namespace clearway {

/// How often a map called free what the next scan hit: before each scan is integrated, voxels that it hits
/// are looked up in the map that was there before, so that they are held out by construction. A place is
/// stable where the voxel, or one that shares a face with it, was occupied before.
struct ScanAgreement {
  std::uint64_t looked_up = 0;    ///< voxels hit in stable places
  std::uint64_t called_free = 0;  ///< of these, voxels that the map called free
  std::uint64_t compared = 0;     ///< voxels hit, wherever they are; 0: a file that does not say
  std::uint64_t amid_free = 0;    ///< of these, voxels that the map called free and that are not stable

  /// 0 when nothing was looked up.
  double share_called_free() const {
    return looked_up == 0 ? 0.0 : static_cast<double>(called_free) / static_cast<double>(looked_up);
  }
  void add(const ScanAgreement& other) {
    looked_up += other.looked_up;
    called_free += other.called_free;
    compared += other.compared;
    amid_free += other.amid_free;
  }
  bool operator==(const ScanAgreement&) const = default;
};

}  // namespace clearway
