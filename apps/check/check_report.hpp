#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/check/check_contract.hpp"
#include "apps/check/rate_terms.hpp"
#include "planning/check/motion_check.hpp"
#include "planning/check/motion_torques.hpp"
#include "planning/check/path_check.hpp"
#include "planning/check/spline_check.hpp"

namespace clearway {

/// All that `check` found out about a plan.
struct CheckReport {
  Contract contract;
  std::vector<Deviation> deviations;
  std::optional<MotionVerdict> motion{};   ///< of the plan's motion, when it has one
  std::optional<TorqueFinding> torques{};  ///< of a motion that is valid but for these
  std::optional<SplineVerdict> splines{};  ///< of a trajectory with times; its path is `path`
  std::vector<UnjudgedRate> unjudged{};    ///< of that trajectory
  double motion_duration = 0.0;            ///< seconds, of motion or trajectory
  PathVerdict path;                        ///< of the plan's waypoints under the contract
  PathSurvey survey;                       ///< what the map knows of where they lead
  PlanStatus plan_status = PlanStatus::no_path;
  std::size_t waypoints = 0;
  std::string map_integration{};  ///< which integration made the map
  std::string torque_caveat{};    ///< what the torques leave out, one sentence; may be empty
  std::string map_caveat{};       ///< what the verdict must say of that, one or two sentences; may be empty

  /// Path and motion hold, and the plan loosens nothing that the user does not accept.
  bool is_valid() const;
  std::string_view word() const;  ///< "valid", "undecided" or "refused"
};

/// Name and text of each line of the verdict.
std::vector<std::pair<std::string, std::string>> check_rows(const CheckReport& report);

/// The same as one JSON object: `contract` has `value` and `source` of each term.
nlohmann::ordered_json check_json(const CheckReport& report);

}  // namespace clearway
