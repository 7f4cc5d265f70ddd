#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "apps/console/commands.hpp"
#include "mapping/snapshot.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot/inverse_dynamics.hpp"

namespace clearway {

/// Where a term of the contract comes from: a flag of `check`; the map folder's own record of its queries;
/// the plan file; or what the robot's settings and the map give by default.
enum class TermSource { flag, map, plan, by_default };
std::string_view to_string(TermSource source);  ///< "flag", "map", "plan", "default"

template <typename Value>
struct Term {
  Value value;
  TermSource source = TermSource::by_default;
};

/// What a path must keep to be called valid, each term with its source. Start and goals may be missing, when
/// nothing states them: `start` is then of no size.
struct Contract {
  Term<std::string> robot;                   ///< as named
  Term<std::string> group;                   ///< planning group; empty: all joints but those held
  std::map<std::string, Term<double>> held;  ///< joints that stand still, rad or m at full size
  std::vector<std::string> held_apart;       ///< where `query` has one of them elsewhere, a sentence each
  Term<double> scale;
  Term<Eigen::Isometry3d> map_from_base;
  std::map<std::string, Term<Policy>> policies;  ///< of every part, loads included
  Term<std::vector<LegLoad>> loads;              ///< that ride on the robot
  Term<std::optional<Pick>> pick;                ///< what is taken; its load is not in `loads`
  Term<double> payload;                          ///< kg at the tip, full size
  Term<Eigen::Vector3d> gravity;                 ///< m/s^2, map frame
  /// Seconds that the motion rests where a load begins or ends to ride; none of a plan without a motion.
  Term<std::optional<double>> grip_time;
  Term<double> padding;            ///< metres
  Term<double> seen_within;        ///< of parts under known_free, seconds; 0: ever
  double position_accuracy = 0.0;  ///< of the robot at the contract's scale, metres
  SurveyDemands demands;           ///< of the flags; parts outside also of the map's query
  Term<std::string> map_sha256;
  double map_resolution = 0.0;  ///< m, as the map was read
  Term<Configuration> start;
  Term<std::vector<Configuration>> goals;
  /// Poses in place of goals, one for each of the last legs: then `goals` are where the plan's legs end.
  std::vector<GoalPose> goal_poses;
  std::string tip;                 ///< link that they, and a pick's grasp, place; empty: the robot's own tip
  Term<std::string> tip_link;      ///< the link that this is; empty where neither poses nor a pick ask
  std::string query;               ///< name of the map's query that terms are taken from; empty: none
  std::vector<std::string> notes;  ///< what a reader should know of the sources, one sentence each
};

/// One thing in which the plan asks for less than the contract, or leaves it.
struct Deviation {
  AcceptedTerm term;
  std::string sentence;  ///< what was expected and what the plan says
  bool is_accepted = false;
};

/// The robot as --robot, --srdf, --group and --fix name it. Where neither --group nor --fix is given, the
/// group is the plan's; a held joint stands where --fix or the robot's settings put it, else where the plan
/// does.
Robot robot_to_check(const CheckOptions& options, const Plan& plan);

/// The start by whole turns of joints without limits as near to the plan's as it comes; as it is where the
/// two are of other joints.
Configuration turned_to(const Plan& plan, const Robot& robot, const Configuration& start);

/// States the contract. Each term is taken from the flags; else from the map's record of the plan's query,
/// or of one that the plan answers in part, when that is of this map and of the robot that --robot names;
/// else from the plan. Three terms do not follow the plan where it asks for less: the scale is then the
/// robot's own, the padding its position accuracy, and a part of which the plan says nothing has the policy
/// that it would have by default. Where the record holds other queries for that robot and scale, the plan's
/// policies are no looser than the loosest of theirs, the least padding is the smallest of theirs where that
/// is less, base, age limit and gravity have to be those of one of them, and what the plan carries at least
/// what one of them does. A record is for a robot, whichever of its joints move. What a plan carries that
/// neither flags nor record name counts, since it asks for more. A load whose policy they do not name keeps
/// what its holders keep. A pick is never taken from the plan, because it frees voxels and lets things touch.
/// @param robot robot_to_check() @param is_timed whether there is a motion, whose torques are judged
/// @throws std::invalid_argument for a flag or a plan that does not fit the robot.
Contract state_contract(const CheckOptions& options, const Plan& plan, const Robot& robot,
                        const Snapshot& map, const std::string& map_digest,
                        const std::optional<QueryRecord>& record, bool is_timed);

/// All in which the plan loosens the contract: another robot, scale, base or map; a policy that is looser or
/// missing, a smaller padding; a load that is missing or another, a smaller payload or another gravity;
/// another start, goals or poses of goals that its legs do not reach one after the other. What the plan
/// tightens is none.
/// @param robot robot_to_check()
std::vector<Deviation> deviations(const Contract& contract, const Plan& plan, const Robot& robot,
                                  const std::set<AcceptedTerm>& accepted);

/// Takes from the plan what it loosens and the user accepts: scale, base, policies, padding, loads, payload
/// and gravity; with a pick the tip that it was made for, unless --tip names one.
/// @param robot robot_to_check()
void adopt_accepted(const std::vector<Deviation>& found, const Plan& plan, const Robot& robot,
                    Contract& contract);

/// States `tip_link` by `tip`, of which this is the source.
void state_tip(const Robot& robot, TermSource source, Contract& contract);

/// The robot at the scale and base of the contract, without its loads.
Robot robot_of(const Contract& contract, const Robot& robot);

/// The same, with the tip that the contract's pick grasps with: of a pick of the map the robot's own. Without
/// a pick the tip is the robot's own, too, at which the payload hangs, whatever link goal poses are of.
Robot tipped_robot_of(const Contract& contract, const Robot& robot);

/// The loads of the contract; of a pick its object on the legs that carry it.
std::vector<LegLoad> carried_under(const Contract& contract);

/// What hangs on the robot of that scale and pulls it.
JointLoad joint_load_of(const Contract& contract);

/// The policy of each part.
std::map<std::string, Policy> policies_of(const Contract& contract);

}  // namespace clearway
