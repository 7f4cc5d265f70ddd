#pragma once

#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// What the independent check found.
struct PathVerdict {
  bool valid = false;
  bool undecided = false;      ///< a place is neither proved free nor shown to collide at the finest step,
                               ///< and no contact was found beyond it; not valid
  double min_clearance = 0.0;  ///< to blocked voxels: certified lower bound over the whole path, metres,
                               ///< within 20 % of the true one, at most the cap; 0 when not valid
  std::string first_contact;   ///< empty when valid: edge, parameter, part, voxel state and place; after
                               ///< an undecided place of one of 2,000 places along the path
  int edge = -1;               ///< of the first contact
  double parameter = 0.0;      ///< along that edge, 0..1
  std::vector<double>
      clearance;  ///< to blocked voxels at each waypoint before the first contact or undecided
                  ///< place, metres, capped at `distance_cap` (0: 0.2 m, times the robot's scale)
  std::string checker = "kdl+fcl";  ///< whose kinematics and geometry decided
};

/// Re-checks a path in code that no planner shares: KDL kinematics, shapes against voxel boxes read straight
/// from the tree, separating planes as proof, FCL `collide` and unsigned `distance` where a plane of our own
/// does not close (always where something touches), conservative advancement along each edge with reach
/// bounds of its own. Contract as ConfigurationSpace: for EVERY configuration on every straight edge. Parts
/// that `policies` does not name are `not_occupied`. A path of one waypoint is checked there; no waypoint, a
/// wrong size, NaN and values outside the joint limits are refused, naming the waypoint (`edge` is then its
/// index).
///
/// Of a robot that was loaded from a file (Robot::source) the kinematics are what urdfdom and kdl_parser read
/// from its URDF, in which our own reader has no part. When they put a link or body more than 1e-9 m or rad
/// elsewhere than the planners' kinematics do, or the file has narrower limits or other bodies, the path is
/// refused in a sentence that names link, joint or body. A robot that was made in memory has no source: its
/// KDL chain is built from it. Who changes a loaded robot's links, joints or bodies clears its source.
/// Loads (Robot::loads) are placed, shaped and held as they are stated there; where the robot's own links
/// and bodies say otherwise the path is refused.
/// @param seen_within of parts under `known_free`: voxels that were seen free, but not in the last so many
///        seconds up to the map's newest look, count as unknown; 0: whenever they were seen.
/// @throws std::invalid_argument for a padding or cap that is no length, a part in `policies` that no body is
/// of, a seen_within that the map cannot answer or that no part is asked, an edge that sweeps too many
/// voxels, or a robot's file that can no longer be read.
PathVerdict check_path(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                       double padding, const std::vector<Configuration>& waypoints, double distance_cap = 0.0,
                       double seen_within = 0.0);

/// Empty, or the sentence with which check_path would refuse any path, because the planners' robot is not
/// what its file says: for programs that let motions pass and are no planners. @throws as check_path
std::string file_disagreement(const Robot& robot);

/// The same for every configuration of which no joint is farther than deviations[i] (rad or m, one value for
/// each joint) from where it is at one place of edge i: a tube about each edge, for curves that stay in it.
/// Of joint limits only those of the waypoints are asked. No deviations: none. Policies may name parts of
/// loads that ride on other legs.
/// @throws std::invalid_argument too for deviations that are not one for each edge, finite and not below 0.
PathVerdict check_tubes(const Robot& robot, const Snapshot& map,
                        const std::map<std::string, Policy>& policies, double padding,
                        const std::vector<Configuration>& waypoints,
                        const std::vector<Eigen::VectorXd>& deviations, double distance_cap = 0.0,
                        double seen_within = 0.0);

}  // namespace clearway
