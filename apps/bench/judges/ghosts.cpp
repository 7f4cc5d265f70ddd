#include "apps/bench/judges/ghosts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;
using Cell = std::array<int, 3>;

bool is_blocked(const Voxel& voxel) {
  return voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
}

/// Ghosts of one kind: those farther from every solid than `least_distance`.
class GhostWatch {
 public:
  explicit GhostWatch(double least_distance) : least_distance_(least_distance) {}

  /// What the newest scan did to the ghosts that are there.
  void follow(const Snapshot& before, const Snapshot& after) {
    std::erase_if(present_, [&](Ghost& ghost) {
      const Voxel now = after.voxel(ghost.center);
      ghost.looks += now.log_odds < before.voxel(ghost.center).log_odds ? 1 : 0;
      if (is_blocked(now)) return false;
      looks_.push_back(ghost.looks);
      return true;
    });
  }

  /// A voxel that is blocked now and was not before, and how far its sphere is from the nearest solid.
  void met(const Eigen::Vector3d& center, double distance) {
    if (distance <= least_distance_) return;
    ++ghosts_;
    present_.push_back({center});
  }

  Json json(std::size_t rays) const {
    std::vector<int> looks = looks_;
    std::sort(looks.begin(), looks.end());
    double sum = 0.0;
    for (const int count : looks) sum += count;
    const double millions = static_cast<double>(rays) / 1e6;
    Json lasting;
    if (!looks.empty()) {
      lasting = {{"mean", sum / static_cast<double>(looks.size())},
                 {"median", looks[looks.size() / 2]},
                 {"most", looks.back()}};
    }
    return {{"per_million_rays", static_cast<double>(ghosts_) / millions},
            {"gone", looks.size()},
            {"looks_until_free", lasting},
            {"left_at_the_end", present_.size()}};
  }

 private:
  struct Ghost {
    Eigen::Vector3d center;
    int looks = 0;
  };
  double least_distance_;
  std::vector<Ghost> present_;
  std::vector<int> looks_;
  std::size_t ghosts_ = 0;
};

/// The voxels in which the scan's points lie; counts the rays that count.
std::set<Cell> hit_voxels(const Scan& scan, double max_range, double resolution, std::size_t& rays) {
  std::set<Cell> cells;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d measured = point.cast<double>();
    if (!measured.allFinite() || measured.norm() > max_range) continue;
    ++rays;
    const Eigen::Vector3d cell = ((scan.map_from_sensor * measured).array() / resolution).floor();
    cells.insert({static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())});
  }
  return cells;
}

}  // namespace

Json watch_ghosts(const NoiseLaw& law, double resolution) {
  const RoomErrors& errors = law.errors;
  constexpr unsigned looks = 10;
  constexpr std::size_t walk = 8;  // frames of a round, of which the first is seen each time
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  const double half_diagonal = 0.5 * std::sqrt(3.0) * resolution;
  GhostWatch all(0.0), open(2.0 * map.options().margins.band);
  std::size_t rays = 0;
  for (unsigned look = 0; look < looks; ++look) {
    const FurnishedRoom room(walk, 100 + look, errors);
    const double max_range = room.camera().max_range;
    CloudFrame frame = room.frame(0);
    disturb(law, look, frame);
    const Scan scan = scan_of(frame);
    const Snapshot before = map.snapshot();
    map.insert(scan, {.max_range = max_range});
    const Snapshot after = map.snapshot();
    all.follow(before, after);
    open.follow(before, after);
    for (const Cell& cell : hit_voxels(scan, max_range, resolution, rays)) {
      const Eigen::Vector3d center = (Eigen::Vector3d(cell[0], cell[1], cell[2]).array() + 0.5) * resolution;
      if (is_blocked(before.voxel(center)) || !is_blocked(after.voxel(center))) continue;
      const double distance = room.distance_to_solid(center) - half_diagonal;
      all.met(center, distance);
      open.met(center, distance);
    }
  }
  return {{"noise", law.name},
          {"resolution", resolution},
          {"pose_shift", errors.sequence.pose_shift},
          {"pose_turn", errors.sequence.pose_turn},
          {"looks", looks},
          {"rays", rays},
          {"all", all.json(rays)},
          {"in_the_open", open.json(rays)}};
}

}  // namespace clearway::bench
