#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/files/plan_file.hpp"
#include "planning/problem/path_cost.hpp"
#include "planning/problem/planner.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

/// A query of one or several legs, and what to answer it with. `space`, `start` and `goals` have to be given:
///   const Plan plan = plan_and_check({.space = space, .start = start, .goals = {goal}});
struct PlanQuery {
  const ConfigurationSpace& space;   ///< robot, map, policy of each part, padding; outlives the call
  Configuration start;               ///< rad or m, one value for each joint, in the robot's order
  std::vector<Configuration> goals;  ///< the same, at least one; visited in this order, each ends a leg
  /// Null: `auto` with its defaults. Else of a struct of options, or of a name and text:
  ///   std::make_shared<Beam>(BeamOptions{.width = 20}), make_planner("beam", {{"width", "20"}})
  std::shared_ptr<const Planner> planner = nullptr;
  std::uint64_t seed = 1;    ///< of the planner, for every leg
  double time_limit = 60.0;  ///< seconds for each leg, > 0; may be infinite
  /// Objects that ride on the robot, on single legs or on all: one more body on these for planner, cost and
  /// check. `space` is of the robot without them.
  std::vector<LegLoad> loads = {};
  std::map<std::string, Policy> load_policies = {};       ///< of loads by name; others keep their holders'
  double payload = 0.0;                                   ///< kg at the tip, full size, for the path cost
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};               ///< m/s^2, map frame, for the path cost
  std::optional<SurveyDemands> survey = SurveyDemands{};  ///< none: no survey, and nothing is refused for it
  /// Seconds, at most, and at most time_limit, to look where painting would connect the ends of a leg that
  /// failed; 0: no look.
  double advice_time = 5.0;
  /// Whether PlanResult::work of the legs is wanted (work_meter.hpp), which costs two looks at a clock for
  /// each edge.
  bool splits_cpu = false;

  // For the plan's file alone.
  std::string robot_name = {};          ///< name or path that load_robot takes; empty: the robot's own name
  std::filesystem::path map_file = {};  ///< where the map was loaded from
  std::string map_digest = {};          ///< map_sha256 of that file
  std::string name = {};                ///< of this query in the map folder's record; empty: none
};

/// Plans leg after leg, each from where the one before really ended, then has the independent check look at
/// the whole path, and surveys what the map knows of where the robot goes. Plan::is_proved() is the answer in
/// one word (a beam search may end in its goal's box, short of the goal); status, explanation,
/// validation and survey are its reasons. The first leg that fails ends the plan: check and survey then cover
/// the legs before it, and `paint` says where painting would help.
///
/// A start or goal that is not finite, past a limit or not free, no path, and time that is out are outcomes.
/// It is made of parts that may be called alone: Planner::plan, check_path (planning/check/path_check.hpp),
/// survey_path, advise_paint (planning/advice/paint_advice.hpp). Safe from several threads.
/// @throws std::invalid_argument in one sentence naming the field, its value and what was expected: a start
/// or
///         goal of a wrong size, no goal, a limit, payload or gravity that is none, a part in the survey's
///         allow_outside that the robot does not have; a load that with_load refuses, or on a leg that there
///         is not; and what planner, check and survey refuse of robot and
///         map.
Plan plan_and_check(const PlanQuery& query);

/// A plan without legs: what it says of robot, map, terms and cost. @throws std::invalid_argument for fields
/// of the query that are wrong; goals may be none.
Plan empty_plan(const PlanQuery& query, const Planner& planner);

/// The path cost of the query's robot without its loads: its gravity is turned into the frame of the robot's
/// base.
/// @throws std::invalid_argument when gravity is not finite, or the payload negative or not finite.
PathCost path_cost(const PlanQuery& query);

/// The same of that robot with loads, or another one at its place.
PathCost path_cost(const PlanQuery& query, const Robot& robot);

}  // namespace clearway
