#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>

namespace clearway {

/// Corners, metres.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Whether a closed triangle and the closed box about `center` have a point in common, by the 13 axes that
/// can separate them (Akenine-Moller 2001); nearer to each other than some 1e-9 of their size counts as one.
/// @param half edges of the box, halved
bool triangle_meets_box(const Triangle& triangle, const Eigen::Vector3d& center, const Eigen::Vector3d& half);

/// Calls `visit` once for each cell that the triangle meets, as above: cell (i, j, k) reaches from
/// `edge` (i, j, k) on by `edge` along each axis. Takes time in proportion to their number.
/// @param triangle finite; of what lies more than 1e9 edges from the origin no cell is promised
void visit_cells_met(const Triangle& triangle, double edge,
                     const std::function<void(const Eigen::Vector3i&)>& visit);

}  // namespace clearway
