#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway {

/// True for a name that ends in .bin, in small or capital letters.
bool is_velodyne_file(const std::filesystem::path& file);

/// What a scan of KITTI or nuScenes holds, in the scanner's frame (x forward, y left, z up), m.
struct VelodyneScan {
  std::vector<Eigen::Vector3f> points;  ///< those that can be used
  std::size_t not_finite = 0;           ///< left out: NaN, infinite
  std::size_t at_origin = 0;            ///< left out: where drivers put what did not come back
  std::size_t too_far = 0;              ///< left out: farther than a kilometre along an axis

  std::size_t left_out() const { return not_finite + at_origin + too_far; }
  /// "3 are not finite, 5 lie at the scanner's own origin"; "" when nothing is left out
  std::string reasons() const;
};

/// Reads a .bin file as KITTI's scans are: x, y, z and intensity of each point as little-endian floats of 4
/// bytes, without a head; a .pcd.bin as nuScenes' are, with the ring as a fifth.
/// @throws std::invalid_argument when there is no such file or it has more than 4 GB; DamagedFile when its
/// size is no multiple of 16 (20), or when it is of another kind: more than one in a hundred of its points
/// has an intensity below 0 or that is not finite, or more than half lie where no scanner measures.
VelodyneScan read_velodyne_scan(const std::filesystem::path& file);

}  // namespace clearway
