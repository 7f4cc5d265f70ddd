#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace clearway::bench {

using Points = std::vector<Eigen::Vector3d>;

/// `count` points uniformly in the box; `run` of them at a time on a line, 5 mm apart.
Points look_up_points(const Eigen::AlignedBox3d& box, std::size_t count, std::size_t run);

/// A body of 64 spheres, a metre long, that moves by 5 mm and turns by 5 mrad a step about the middle of the
/// box, the other way when it would leave it; sphere after sphere of each of 128 steps, then somewhere else.
Points body_points(const Eigen::AlignedBox3d& box, std::size_t count);

}  // namespace clearway::bench
