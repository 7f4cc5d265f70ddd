#pragma once

#include <cstdint>

namespace clearway {

/// How often a map called free what the next scan hit: before each scan is integrated, voxels that it hits
/// are looked up in the map that was there before, so that they are held out by construction. Only stable
/// places count: the voxel, or one that shares a face with it, was occupied before.
struct ScanAgreement {
  std::uint64_t looked_up = 0;    ///< voxels hit in stable places
  std::uint64_t called_free = 0;  ///< of these, voxels that the map called free

  /// 0 when nothing was looked up.
  double share_called_free() const {
    return looked_up == 0 ? 0.0 : static_cast<double>(called_free) / static_cast<double>(looked_up);
  }
  void add(const ScanAgreement& other) {
    looked_up += other.looked_up;
    called_free += other.called_free;
  }
  bool operator==(const ScanAgreement&) const = default;
};

}  // namespace clearway
