#pragma once

#include <string>
#include <vector>

#include "planning/check/motion_check.hpp"
#include "planning/check/path_check.hpp"
#include "planning/problem/pick.hpp"

namespace clearway {

/// What a plan says of a pick, to be checked.
struct PickToCheck {
  const Robot& robot;                            ///< without loads
  const Snapshot& map;                           ///< with the object
  const Pick& pick;                              ///< as it is stated, not as the plan has it
  Eigen::Isometry3d link_from_load;              ///< where the plan says that the object rides
  std::vector<std::vector<Configuration>> legs;  ///< of the plan: as Pick lists them
};

/// Checks a picked object's way in code that no planner shares: check_path of every leg with the bodies and
/// voxels that Pick states for it; the object's voxels and the layers are found anew, by FCL; where the plan
/// grasps and puts the object is compared with what the pick states (1e-5 m and rad, 1e-3 for the tip); how
/// low the load comes on the first and last metres is proved by conservative advancement over KDL's
/// kinematics. Edges are numbered over all legs. Clearances are those of the path as it is checked.
/// @throws std::invalid_argument as check_path, or for a pick that is not sound.
PathVerdict check_pick(const PickToCheck& plan, const std::map<std::string, Policy>& policies, double padding,
                       double seen_within = 0.0);

/// What a pick takes for granted and neither map nor robot shows, a sentence each:
/// - no obstacle is in the object's own voxels: it may not stand there;
/// - no obstacle is in the layer on which the object is put down (Pick), or in voxels that reach into it from
///   below, the object's own aside: it may not stay there;
/// - at the grasp nothing of the hand (the link that carries the object and `touches`) is near it, or a hand
///   with a `grip` closes deeper into it than Pick::depth.
/// @throws std::invalid_argument for a pick that is not sound.
std::vector<std::string> pick_notes(const PickToCheck& plan, double padding);

/// Checks a motion along the path of a pick as check_motion does, with what Pick states for each leg about
/// the curve itself: bodies, voxels, the straight ways, and how low the load comes while it may touch what it
/// stands on. The robot rests where it takes the object and where it lets go.
/// @pre check_pick found the path valid @throws as check_pick and check_rates
MotionVerdict check_pick_motion(const PickToCheck& plan, const MotionToCheck& motion,
                                const std::map<std::string, Policy>& policies, double padding,
                                double seen_within = 0.0);

}  // namespace clearway
