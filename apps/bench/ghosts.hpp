#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "datasets/room.hpp"
#include "mapping/scan.hpp"
#include "mapping/snapshot.hpp"

namespace clearway::bench {

/// Counts ghosts: voxels that a spurious return blocks though nothing solid comes into them, and how many
/// later looks each lasts. A look is a scan that lowers the voxel's log-odds.
class GhostWatch {
 public:
  GhostWatch(const FurnishedRoom& room, double max_range) : room_(room), max_range_(max_range) {}

  /// After each scan, with the map before and after it.
  void inserted(const Scan& scan, const Snapshot& before, const Snapshot& after);

  nlohmann::ordered_json json() const;

 private:
  struct Ghost {
    Eigen::Vector3d center;
    int looks = 0;
  };
  void follow(const Snapshot& before, const Snapshot& after);

  const FurnishedRoom& room_;
  double max_range_;
  std::vector<Ghost> present_;
  std::vector<int> looks_of_gone_;
  std::size_t rays_ = 0, ghosts_ = 0;
};

}  // namespace clearway::bench
