#include "planning/lattice_poses.hpp"

#include "planning/link_pose.hpp"

namespace clearway {

Eigen::Isometry3d LatticePoses::computed(std::size_t link, int index, int toward) const {
  const Link& which = robot_.links[link];
  if (which.joint < 0) return pose_on_parent(robot_, which, 0.0);
  const double from = lattice_.value(which.joint, index);
  if (toward == 0) return pose_on_parent(robot_, which, from);
  return pose_on_parent(robot_, which, from + 0.5 * (lattice_.value(which.joint, index + toward) - from));
}

/// The table is continued up to the index, and a little farther.
const Eigen::Isometry3d& LatticePoses::added(Table& table, std::size_t link, int index, int toward) {
  constexpr int more = 8;
  if (table.poses.empty()) table.first = index;
  std::vector<Eigen::Isometry3d> before;
  if (index < table.first) {
    for (int at = index - more; at < table.first; ++at) before.push_back(computed(link, at, toward));
    table.first = index - more;
    table.poses.insert(table.poses.begin(), before.begin(), before.end());
  }
  while (index + more >= table.first + static_cast<int>(table.poses.size()))
    table.poses.push_back(computed(link, table.first + static_cast<int>(table.poses.size()), toward));
  return table.poses[static_cast<std::size_t>(index - table.first)];
}

}  // namespace clearway
