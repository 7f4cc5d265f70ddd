#pragma once

#include <vector>

#include "datasets/simulation/surface.hpp"

namespace clearway {

/// The shapes and the fixed boards of a scene as a camera sees them.
std::vector<Surface> still_surfaces(const Scene& scene);

/// The probe at a pose: the tags of its board, the ball, and a thin stick between them.
std::vector<Surface> probe_surfaces(const Setup& setup, const Eigen::Isometry3d& map_from_probe);

}  // namespace clearway
