#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "planning/beam/beam_lattice.hpp"
#include "planning/beam/lattice_poses.hpp"
#include "planning/space/body_collision.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/space/known_clearances.hpp"

namespace clearway {

struct EdgePoses;

/// ConfigurationSpace for a search that moves from node to neighbouring node of a lattice: the same answers,
/// sooner, by what such steps share.
/// - A body (or pair of bodies) that was farther from what blocks it than the step can move it is free at the
///   next node, and on the way there, without a look.
/// - Poses of links on their parents come from a table over each joint's indices.
/// - What blocked a body lately is looked at first.
/// The space and the lattice must outlive it; not for several threads at once.
class LatticeChecks {
 public:
  LatticeChecks(const ConfigurationSpace& space, const Lattice& lattice);
  ~LatticeChecks();

  /// The first joints, so many, alone decide what is free: a last joint that turns a round tool about its own
  /// axis changes nothing.
  std::size_t deciding_joints() const { return deciding_joints_; }

  /// The clearances of a node that is known to be free.
  KnownClearances measure(const LatticeIndex& node);

  /// ConfigurationSpace::is_free of a node that is one step from the free node `neighbour`. When it is, `own`
  /// holds its clearances.
  bool is_free(const LatticeIndex& node, const LatticeIndex& neighbour, const KnownClearances& of_neighbour,
               KnownClearances& own);

  /// Of the last node that was not free: all nodes with the same first joints, so many, are not free either.
  std::size_t blocking_joints() const { return joints_of_[order_.front()]; }

  /// ConfigurationSpace::is_edge_free between two free nodes, one step from each other. It may learn more of
  /// their clearances.
  bool is_edge_free(const LatticeIndex& from, KnownClearances& of_from, const LatticeIndex& to,
                    KnownClearances& of_to);

 private:
  const Eigen::Isometry3d& pose(std::size_t link);
  void go_to(const LatticeIndex& node);
  void place_edge(const LatticeIndex& from, const LatticeIndex& to);
  void find_motion(const LatticeIndex& from, const LatticeIndex& to);
  bool refresh(std::size_t member, KnownClearances& own);
  double quick_clearance(std::size_t member);

  const CollisionModel& model_;
  WorkMeter* meter_;
  const Lattice& lattice_;
  LatticePoses poses_;
  std::size_t deciding_joints_ = 0;
  std::vector<std::size_t> joints_of_;  ///< of each member: the first joints, so many, alone place it
  LatticeIndex node_;                   ///< whose poses are known
  LinkPoses map_from_link_;
  std::vector<char> placed_;
  std::unique_ptr<EdgePoses> edge_;       ///< under test
  Eigen::MatrixXd step_motion_;           ///< of each member (row) by one step of each joint (column), metres
  Eigen::VectorXd whole_motion_;          ///< by one step of all joints
  std::vector<double> slack_;             ///< what an edge's quick proof may lose, metres
  std::vector<double> edge_margin_;       ///< at least what a proof of an edge asks of its ends, with padding
  std::vector<double> motion_;            ///< of each member over the step under test
  std::vector<Eigen::VectorXd> motions_;  ///< the same by the joints that move, empty till it is asked for
  std::vector<std::size_t> order_;        ///< of the members, the one that was blocked last first
  std::vector<RecentCubes> recent_;       ///< of each body
  std::vector<int> open_;                 ///< members that an edge has to prove
};

}  // namespace clearway
