#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A point on a path: at `share` (0 to 1) of the edge that starts at waypoint `edge`.
struct PlaceOnPath {
  std::size_t edge = 0;
  double share = 0.0;
};

/// ||weight (q - q')|| of each edge.
std::vector<double> edge_lengths(const std::vector<Configuration>& path, const Eigen::VectorXd& weight);

/// Sum of ||q - q'|| over all edges, radians and metres alike.
double joint_space_length(const std::vector<Configuration>& path);

/// The place at length `along` from the path's start, given the lengths of its edges (at least one).
PlaceOnPath place_at(const std::vector<double>& lengths, double along);

/// The configuration there; at the end of an edge exactly its waypoint.
Configuration point_at(const std::vector<Configuration>& path, const PlaceOnPath& place);

/// True when every edge is certified free; `edges` is raised by those asked for.
bool is_certified(const ConfigurationSpace& space, const std::vector<Configuration>& path,
                  std::uint64_t& edges);

}  // namespace clearway
