#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// Whether a folder has a matrix for a picture: a .txt file called as the picture is (MobileBrick).
bool has_matrix_of(const std::filesystem::path& folder, const std::filesystem::path& picture);

/// The cameras of pictures, each by the matrix of its colour picture in such a folder.
/// @param size of the colour pictures, whose pixels the matrices count; empty: not known
/// @throws std::invalid_argument naming a file that is no camera's matrix of pictures of this size, or that
/// is not there
std::vector<CameraIntrinsics> cameras_of_matrices(const std::filesystem::path& folder,
                                                  const std::vector<std::filesystem::path>& pictures,
                                                  const std::optional<ImageSize>& size);

}  // namespace clearway
