#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/commands.hpp"
#include "mapping/snapshot.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/problem/planner.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

/// Applies the choices of a command line to a loaded robot: scale and base.
Robot choose_robot(const RobotChoice& choice);

/// The distance that every body keeps, metres: as chosen, else the robot's position accuracy.
double choose_padding(const RobotChoice& choice, const Robot& robot);

/// "P" sets every part, "PART=P" one part. @throws std::invalid_argument for an unknown part or policy.
Policies choose_policies(const std::vector<std::string>& texts, const Robot& robot);

/// The policy of each part in one line: "tool painted, other parts known_free, seen within 5 s".
std::string describe_policies(const std::map<std::string, Policy>& policies, double seen_within);

/// "key=value" texts as planner options. @throws std::invalid_argument for a text without '='.
PlannerOptions choose_planner_options(const std::vector<std::string>& texts);

/// A query of several legs with one planner in one configuration space.
struct Query {
  const ConfigurationSpace& space;
  std::string robot_name;
  std::filesystem::path map_file;
  std::string map_digest;
  Configuration start;
  std::vector<Configuration> goals;
  std::string planner;
  PlannerOptions options;
  std::uint64_t seed = 1;
  double time_limit = 60.0;                               ///< seconds for each leg
  double payload = 0.0;                                   ///< kg at the tip, full size, for the path cost
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};               ///< m/s^2, map frame, for the path cost
  std::optional<SurveyDemands> survey = SurveyDemands{};  ///< none: no survey, and nothing is refused for it
  std::string name = {};  ///< in the map folder's record of its queries; empty: none
};

/// The path cost of the query's robot: gravity is turned into the frame of its base.
PathCost path_cost(const Query& query);

/// Plans leg after leg, each from where the one before really ended, then has the independent check look at
/// the whole path, and says what the map knows of where the robot goes. The first leg that fails ends the
/// plan; the check then covers the legs before it.
Plan solve(const Query& query);

/// The same with a planner that is made already (`query.planner` is only named in the plan).
Plan solve(const Query& query, const Planner& planner);

/// The rows of the table that `plan` and `replay` print for a plan: name and text.
std::vector<std::pair<std::string, std::string>> plan_figures(const Plan& plan);

}  // namespace clearway
