#include "apps/bench/ghosts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace clearway::bench {
namespace {

bool is_blocked(const Voxel& voxel) {
  return voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
}

}  // namespace

void GhostWatch::follow(const Snapshot& before, const Snapshot& after) {
  std::erase_if(present_, [&](Ghost& ghost) {
    const Voxel now = after.voxel(ghost.center);
    ghost.looks += now.log_odds < before.voxel(ghost.center).log_odds ? 1 : 0;
    if (is_blocked(now)) return false;
    looks_of_gone_.push_back(ghost.looks);
    return true;
  });
}

void GhostWatch::inserted(const Scan& scan, const Snapshot& before, const Snapshot& after) {
  follow(before, after);
  const double edge = after.resolution();
  std::set<std::array<int, 3>> met;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d measured = point.cast<double>();
    if (!measured.allFinite() || (max_range_ > 0.0 && measured.norm() > max_range_)) continue;
    ++rays_;
    const Eigen::Vector3d cell = ((scan.map_from_sensor * measured).array() / edge).floor();
    if (!met.insert({static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())})
             .second)
      continue;
    const Eigen::Vector3d center = (cell.array() + 0.5) * edge;
    if (room_.distance_to_solid(center) < 0.5 * std::sqrt(3.0) * edge) continue;
    if (is_blocked(before.voxel(center)) || !is_blocked(after.voxel(center))) continue;
    ++ghosts_;
    present_.push_back({center});
  }
}

nlohmann::ordered_json GhostWatch::json() const {
  std::vector<int> looks = looks_of_gone_;
  std::sort(looks.begin(), looks.end());
  double sum = 0.0;
  for (const int count : looks) sum += count;
  const double millions = static_cast<double>(rays_) / 1e6;
  const bool any = !looks.empty();
  return {{"rays", rays_},
          {"ghosts_per_million_rays", rays_ == 0 ? 0.0 : static_cast<double>(ghosts_) / millions},
          {"left_per_million_rays", rays_ == 0 ? 0.0 : static_cast<double>(present_.size()) / millions},
          {"gone", looks.size()},
          {"looks_until_free",
           {{"mean", any ? sum / static_cast<double>(looks.size()) : 0.0},
            {"median", any ? looks[looks.size() / 2] : 0},
            {"most", any ? looks.back() : 0}}}};
}

}  // namespace clearway::bench
