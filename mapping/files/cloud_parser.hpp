#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace clearway {

/// What a .pcd or .ply file holds.
struct ParsedCloud {
  std::array<float, 7> viewpoint = {};                  ///< x, y, z (m) and qw, qx, qy, qz; not checked
  std::vector<Eigen::Vector3f> points;                  ///< at least one; also those that are not finite
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of a .ply's faces, cut up: indices of `points`
  bool has_lost_faces = false;                          ///< it has some of which no triangle could be read
};

/// Reads a file with PCL, in a child process: PCL crashes on damaged files.
/// @throws std::invalid_argument when there is no such file; DamagedFile when it is cut off or corrupt, or
///         holds no x, y, z.
ParsedCloud parse_cloud(const std::filesystem::path& file);

}  // namespace clearway
