#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/commands.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "planning/plan_and_check.hpp"

namespace clearway {

/// A query as the command line of `plan` asks for it.
struct AskedPlan {
  std::shared_ptr<const Planner> planner;
  Robot robot;
  ChosenStops stops;
  std::vector<NamedGoalPose> goal_poses;
  std::vector<LegLoad> loads;
  std::optional<Pick> pick;
  std::vector<LegLoad> riding;  ///< the loads, or what is picked
  Robot loaded;                 ///< with all of them
  Policies policies;            ///< of the robot's own parts
  std::map<std::string, Policy> load_policies;
};

/// Reads what the flags ask for, so that cheap mistakes are reported before the map is read.
/// @throws std::invalid_argument naming the flag; std::runtime_error for a file that cannot be written
AskedPlan read_query(const PlanOptions& options);

/// The same in a space, which has to live on. @param map_digest of the bytes that its map was read from
PlanQuery query_of(const PlanOptions& options, const AskedPlan& asked, const ConfigurationSpace& space,
                   const std::string& map_digest);

}  // namespace clearway
