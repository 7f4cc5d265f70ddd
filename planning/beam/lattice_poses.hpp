#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "planning/beam/beam_lattice.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Poses of links on their parents at the nodes of a lattice and half way between neighbours, from tables
/// over each joint's indices: bit for bit those of forward_kinematics at the configurations of the nodes, and
/// at from + 0.5 (to - from), prismatic values over `scale`. Robot and lattice must outlive it; not for
/// several threads at once.
class LatticePoses {
 public:
  LatticePoses(const Robot& robot, const Lattice& lattice, double scale = 1.0)
      : robot_(robot), lattice_(lattice), scale_(scale), tables_(3 * robot.links.size()) {}

  /// All links in the map, where these of the last node still hold or anew.
  const LinkPoses& all_at(const LatticeIndex& node);

  /// parent_from_link where the link's joint stands at the node. Holds until the next call.
  const Eigen::Isometry3d& at(std::size_t link, const LatticeIndex& node) {
    const int joint = robot_.links[link].joint;
    return on_parent(link, joint < 0 ? 0 : node[static_cast<std::size_t>(joint)], 0);
  }

  /// The same half way from a node to a neighbour.
  const Eigen::Isometry3d& between(std::size_t link, const LatticeIndex& from, const LatticeIndex& to) {
    const int joint = robot_.links[link].joint;
    if (joint < 0) return on_parent(link, 0, 0);
    const int index = from[static_cast<std::size_t>(joint)];
    return on_parent(link, index, to[static_cast<std::size_t>(joint)] - index);
  }

 private:
  /// Those of one link for a run of indices.
  struct Table {
    int first = 0;
    std::vector<Eigen::Isometry3d> poses;
  };
  /// At `index`, or half way from there to index + toward (-1, 0 or 1).
  const Eigen::Isometry3d& on_parent(std::size_t link, int index, int toward) {
    Table& table = tables_[3 * link + static_cast<std::size_t>(toward + 1)];
    const auto place = static_cast<std::size_t>(index - table.first);
    if (index < table.first || place >= table.poses.size()) return added(table, link, index, toward);
    return table.poses[place];
  }
  const Eigen::Isometry3d& added(Table& table, std::size_t link, int index, int toward);
  Eigen::Isometry3d computed(std::size_t link, int index, int toward) const;

  const Robot& robot_;
  const Lattice& lattice_;
  double scale_;
  std::vector<Table> tables_;  ///< link after link: toward -1, 0, 1
  LinkPoses all_;              ///< at
  LatticeIndex node_;
  std::vector<char> moved_;  ///< of each link, from the last node to this
};

}  // namespace clearway
