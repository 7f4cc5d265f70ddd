#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning/advice/paint_advice.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/check/motion_check.hpp"
#include "planning/check/path_check.hpp"
#include "planning/problem/pick.hpp"
#include "planning/problem/planner.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

/// The motion along a plan's path, as plan.json stores it.
struct PlannedMotion {
  MotionScales scales{};  ///< of the robot's limits, that it keeps
  Motion motion{};
  std::vector<std::size_t> leg_ends{};  ///< the knot at which each leg ends, at rest
  double grip_time = 0.0;  ///< seconds that it rests for each load that begins or ends to ride between legs
  std::size_t blended = 0, stops = 0;    ///< waypoints passed without and with a stop; in no file
  std::vector<std::size_t> unblended{};  ///< legs with loads or a pick that stop at each waypoint; in no file
  double cpu_s = 0.0;                    ///< of making it; in no file
  MotionVerdict validation{};            ///< of the independent check
};

/// One plan of one or several legs, as plan.json stores it (keys fixed by the design page).
struct Plan {
  std::string robot;  ///< name or path, as given
  double robot_scale = 1.0;
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::vector<std::string> joints;
  std::string group{};                   ///< planning group of the SRDF; empty: all joints but those held
  std::map<std::string, double> held{};  ///< joints that stood still, rad or m at full size
  std::map<std::string, std::string> xacro{};  ///< arguments that the robot's .xacro was expanded with
  std::string planner;
  PlannerOptions options;
  std::uint64_t seed = 1;
  std::string map_file, map_sha256;
  double map_resolution = 0.0;
  std::string map_integration{};  ///< which integration made the map; empty: not stated
  std::string map_caveat{};  ///< what a verdict on the map must say of it, one or two sentences; may be empty
  std::map<std::string, Policy> policies;    ///< per part
  double padding = 0.0;                      ///< metres
  double position_accuracy = 0.0;            ///< of the robot at its scale, metres; 0: not known
  double seen_within = 0.0;                  ///< of parts under known_free, seconds; 0: ever
  double payload = 0.0;                      ///< kg at the tip, full size, that costs were reckoned with
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, map frame, of the costs
  std::vector<PlanResult> legs;              ///< each starts where the one before it ended
  std::vector<LegLoad> loads{};              ///< that ride on the robot, on some legs or all
  std::optional<Pick> pick{};                ///< what the legs do, if they pick and place
  std::string tip{};                 ///< link whose poses a pick or poses of goals are of; empty: nobody says
  std::string cost_caveat{};         ///< why the costs say nothing, one sentence; may be empty
  std::string query;                 ///< its name in the map folder's record; empty: none
  Configuration start;               ///< as asked; of no size when the file does not say
  std::vector<Configuration> goals;  ///< as asked
  double time_s = 0.0;
  double cpu_s = 0.0;  ///< of the thread that planned; this and the next two are in no file
  double check_s = 0.0, check_cpu_s = 0.0;  ///< of the independent check
  std::vector<PaintHint> paint;             ///< of a plan that is not solved: where painting would help
  PathVerdict validation;            ///< of the whole path; `valid == false` and empty contact: not checked
  std::optional<PathSurvey> survey;  ///< what the map knows of where the robot goes
  std::optional<PlannedMotion> motion{};  ///< when one was asked for
  std::string motion_caveat{};  ///< why a proved plan has none although it was, one sentence; in no file
  std::vector<std::string> allow_outside;  ///< parts that may leave the map's bounds, or "all"

  PlanStatus status() const;  ///< of the first leg that is not solved, else solved
  /// Every leg is solved, the check found the whole path valid, and it joins what was asked: no
  /// end_violation(true).
  bool is_proved() const;
  /// Why the path does not join start and goals as this plan states them, one sentence without a full stop:
  /// a leg is missing or left over, or ends elsewhere. Empty: it does, or the plan states none.
  /// @param by_goal_box legs of a beam search may end in the goal's box (Chong 2008, eq. 11), as far from the
  ///        goal as they say; `clearway check` refuses those unless told to accept them
  std::string end_violation(bool by_goal_box = false) const;
  std::string explanation() const;
  std::vector<Configuration> waypoints() const;  ///< of all solved legs, joined without doubles
  /// Of waypoints(): how the planner got to each; unknown for legs that do not say.
  std::vector<WaypointOrigin> origins() const;
  std::vector<Configuration> stops() const;  ///< where the first leg begins and each solved one ends
};

/// The solved legs of a plan for the check, those that follow each other with the same loads in one; of a
/// plan without a path one without waypoints.
/// @param robot at the plan's place and scale, without loads
std::vector<LegsToCheck> legs_of(const Plan& plan, const Robot& robot, const Snapshot& map);

/// A plan that picks, for check_pick. @pre plan.pick @param pick as it is stated; outlives the result, as
/// robot and map
PickToCheck pick_of(const Plan& plan, const Pick& pick, const Robot& robot, const Snapshot& map);

/// A plan's motion for the check. @pre plan.motion @param robot at the plan's place and scale
MotionToCheck motion_to_check(const Plan& plan, const Robot& robot);

/// plan.json text, keys in fixed order, numbers with full precision.
std::string to_json(const Plan& plan);

/// @throws std::invalid_argument naming file, field and what was expected.
Plan load_plan(const std::filesystem::path& file);

/// The same from text, as to_json makes it; `name` is what complaints call it: "plan file p.json".
Plan parse_plan(const std::string& text, const std::string& name);

/// Waypoints as CSV with a header of joint names.
std::string to_csv(const Plan& plan);

}  // namespace clearway
