#include "planning/path/path_pieces.hpp"

#include <algorithm>

namespace clearway {

std::vector<double> edge_lengths(const std::vector<Configuration>& path, const Eigen::VectorXd& weight) {
  std::vector<double> lengths;
  for (std::size_t i = 1; i < path.size(); ++i)
    lengths.push_back(weight.cwiseProduct(path[i] - path[i - 1]).norm());
  return lengths;
}

double joint_space_length(const std::vector<Configuration>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

PlaceOnPath place_at(const std::vector<double>& lengths, double along) {
  for (std::size_t i = 0; i + 1 < lengths.size(); ++i) {
    if (along <= lengths[i]) return {i, lengths[i] > 0.0 ? along / lengths[i] : 0.0};
    along -= lengths[i];
  }
  return {lengths.size() - 1, lengths.back() > 0.0 ? std::min(1.0, along / lengths.back()) : 1.0};
}

Configuration point_at(const std::vector<Configuration>& path, const PlaceOnPath& place) {
  if (place.share >= 1.0) return path[place.edge + 1];
  return path[place.edge] + place.share * (path[place.edge + 1] - path[place.edge]);
}

bool is_certified(const ConfigurationSpace& space, const std::vector<Configuration>& path,
                  std::uint64_t& edges) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    ++edges;
    if (!space.is_edge_free(path[i - 1], path[i])) return false;
  }
  return true;
}

}  // namespace clearway
