#include "planning/beam/lattice_poses.hpp"

#include "planning/robot/link_pose.hpp"

namespace clearway {

Eigen::Isometry3d LatticePoses::computed(std::size_t link, int index, int toward) const {
  const Link& which = robot_.links[link];
  if (which.joint < 0) return pose_on_parent(robot_, which, 0.0);
  double q = lattice_.value(which.joint, index);
  if (toward != 0) q = q + 0.5 * (lattice_.value(which.joint, index + toward) - q);
  if (robot_.joints[static_cast<std::size_t>(which.joint)].kind == JointKind::prismatic) q /= scale_;
  return pose_on_parent(robot_, which, q);
}

const LinkPoses& LatticePoses::all_at(const LatticeIndex& node) {
  const bool is_first = all_.empty();
  all_.resize(robot_.links.size());
  moved_.resize(robot_.links.size());
  for (std::size_t i = 0; i < robot_.links.size(); ++i) {
    const Link& link = robot_.links[i];
    const auto joint = static_cast<std::size_t>(link.joint), parent = static_cast<std::size_t>(link.parent);
    moved_[i] = is_first || (link.joint >= 0 && node_[joint] != node[joint]) ||
                (link.parent >= 0 && moved_[parent] != 0);
    if (moved_[i] != 0)
      place_link(link.parent < 0 ? robot_.map_from_base : all_[parent], at(i, node), all_[i]);
  }
  node_ = node;
  return all_;
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
