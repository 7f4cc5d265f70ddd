#include "apps/bench/judges/room_truth.hpp"

#include <cmath>
#include <random>

namespace clearway::bench {

using nlohmann::ordered_json;

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

namespace {

/// True when no solid comes into the cube, up to cubes of an eighth of the edge.
bool is_truly_free(const FurnishedRoom& room, const Eigen::Vector3d& center, double half, int depth = 3) {
  const double distance = room.distance_to_solid(center);
  if (distance >= half * std::sqrt(3.0)) return true;
  if (distance <= half || depth == 0) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    if (!is_truly_free(room, center + 0.5 * half * side, 0.5 * half, depth - 1)) return false;
  }
  return true;
}

}  // namespace

ordered_json compare_with_truth(const FurnishedRoom& room, double resolution, const StateAt& ours,
                                const StateAt& peer) {
  std::mt19937 engine(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  struct Tally {
    std::size_t both = 0, truly_free = 0, inside = 0, touched = 0;
    std::size_t wrong_inside[2]{}, wrong_touched[2]{}, phantom[2]{}, free[2]{};
  } tally;
  for (int i = 0; i < 100'000; ++i) {
    const Eigen::Vector3d point(uniform(-3.2, 3.2), uniform(-2.8, 2.8), uniform(-0.2, 2.9));
    const Eigen::Vector3d center = ((point / resolution).array().floor() + 0.5) * resolution;
    const VoxelState states[2] = {ours(center), peer(center)};
    const double distance = room.distance_to_solid(center);
    const bool truly_free = is_truly_free(room, center, 0.5 * resolution);
    const bool inside = distance <= -0.5 * std::sqrt(3.0) * resolution;
    const bool free[2] = {states[0] == VoxelState::seen_free, states[1] == VoxelState::seen_free};
    tally.truly_free += truly_free;
    tally.inside += inside;
    tally.touched += !truly_free && !inside;
    for (int map = 0; map < 2; ++map) {
      tally.free[map] += truly_free && free[map];
      tally.phantom[map] += truly_free && states[map] == VoxelState::occupied;
      tally.wrong_inside[map] += inside && free[map];
      tally.wrong_touched[map] += !truly_free && !inside && free[map];
    }
    tally.both += truly_free && free[0] && free[1];
  }
  const auto side = [&](int map) {
    return ordered_json{{"inside_obstacles_freed", share(tally.wrong_inside[map], tally.inside)},
                        {"surface_voxels_freed", share(tally.wrong_touched[map], tally.touched)},
                        {"free_voxels_occupied", share(tally.phantom[map], tally.truly_free)}};
  };
  return {{"truly_free_kept", share(tally.both, tally.free[1])}, {"ours", side(0)}, {"peer", side(1)}};
}

}  // namespace clearway::bench
