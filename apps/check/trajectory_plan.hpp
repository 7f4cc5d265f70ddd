#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/check/check_contract.hpp"
#include "apps/check/trajectory_file.hpp"

namespace clearway {

/// The joint of that name that stands still; null where none does.
const HeldJoint* held_joint(const Robot& robot, const std::string& name);

/// Joints of the robot that the trajectory does not name, but of which it says where they are before: a
/// controller leaves them there, and so they are in every point now. Returns their names.
std::vector<std::string> hold_unnamed_joints(ForeignTrajectory& trajectory, const Robot& robot);

/// Values beyond a joint's limit by rounding become the limit (drawn_to_limit); says how far in
/// ForeignTrajectory::drawn.
void draw_to_limits(ForeignTrajectory& trajectory, const Robot& robot);

/// A sentence for each joint that was drawn by more than 1e-9 rad or m.
std::vector<std::string> drawn_notes(const std::vector<ForeignTrajectory>& trajectories);

/// @throws std::invalid_argument naming `file` where it says that the robot's base stands elsewhere, by more
/// than 1e-4 m or rad. The identity says nothing.
void require_base(const ForeignTrajectory& trajectory, const Eigen::Isometry3d& map_from_base,
                  const std::filesystem::path& file);

/// Says which waypoint of the plan has values that look like degrees (looks_like_degrees); empty: none.
std::string degrees_note(const Plan& plan, const Robot& robot);

/// Says that the file is for a robot of another name (model_id), as RViz does; empty where it is not.
std::string model_note(const ForeignTrajectory& trajectory, const Robot& robot);

/// The points as a plan of one leg from the first (where the file says where the robot is before, from there)
/// to the last, in the order of the robot's joints. What the trajectory says of joints that stand still has
/// to be where they stand, and of joints that follow others (mimic) what these make of them, within 1e-4 rad
/// or m (relative, beyond 1), rates and trajectory_start included; slack_of says how far that may take the
/// bodies.
/// @throws std::invalid_argument naming `file` and the joint that the trajectory or the robot lacks, or that
/// stands or follows elsewhere.
Plan plan_of_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                        const std::filesystem::path& file);

/// A trajectory of another program states nothing but its points: the other terms of the contract are the
/// plan's own, and count as being there by default. So are those that one of ours does not state. Notes say
/// what is judged of one without times.
/// @param stated state_terms() has put them into the plan @param is_timed whether timed_trajectory() is
/// judged
void adopt_terms(const std::optional<StatedTerms>& stated, bool is_timed, Contract& contract, Plan& plan);

/// Refuses another planning group than the contract's, where both state one. Where one has none, the joints
/// that are held tell them apart.
std::optional<Deviation> group_deviation(const std::optional<StatedTerms>& stated, const Contract& contract,
                                         const std::set<AcceptedTerm>& accepted);

/// Cuts the one leg of a trajectory, which does not say where legs end, where it comes to the contract's
/// goals in turn, each at one of its points, and notes that. Leaves it whole where it misses one, or where
/// something rides on the robot, which may do so on some legs alone.
void cut_at_goals(Contract& contract, Plan& plan);

}  // namespace clearway
