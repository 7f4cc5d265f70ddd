#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/console/commands.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/pages/report.hpp"
#include "apps/query/loads.hpp"
#include "planning/files/query_record.hpp"
#include "planning/pose_goals.hpp"
#include "planning/problem/pick.hpp"

namespace clearway {

/// All queries of the setup, each with each of its planners, on one map.
class QueryRunner {
 public:
  /// @param folder where the map and the plans are saved; all of these outlive the runner
  /// @throws std::invalid_argument naming the query and the field that is wrong
  QueryRunner(const ReplayOptions& options, const std::filesystem::path& folder, const Fusion& fusion,
              const Snapshot& map);

  /// Plans on the map that was saved in the folder, and records there what was asked.
  std::vector<ReplayPlan> run(Console& console);

  /// Wall time of giving the plans their motions.
  double motion_seconds() const { return motion_s_; }

 private:
  /// The query with the numbers of states that it names.
  QuerySetup in_numbers(QuerySetup query);
  /// Those of one state. @param before the stop before it, where it leaves joints
  std::vector<double> place_of(const QuerySetup& query, const std::string& field, const std::string& state,
                               const std::vector<double>& before);

  /// The query's space and goals. Returns what is recorded of it.
  QueryTerms prepare(std::size_t index);

  /// The plan of a query by one of its planners, with its motion, saved. @pre the query is prepared
  ReplayPlan plan(std::size_t index, const std::string& planner, const std::string& map_digest);

  static std::vector<LegLoad> loads_of(const QuerySetup& query);

  std::optional<Pick> pick_of(const QuerySetup& query) const;

  /// The loads of a query, or what it picks.
  std::vector<LegLoad> riding_of(std::size_t query) const;

  /// Of the robot's own parts, and of its loads.
  std::pair<Policies, std::map<std::string, Policy>> policies_of(const QuerySetup& query,
                                                                 const std::vector<LegLoad>& loads) const;

  void require_tip(const QuerySetup& query) const;

  static std::optional<PoseGoals> poses_of(const QuerySetup& query, const ConfigurationSpace& space);

  QueryTerms terms_of(const QuerySetup& query, const ConfigurationSpace& space,
                      const std::vector<Configuration>& goals) const;

  std::vector<std::string> planners(const QuerySetup& query) const;

  double seen_within(const QuerySetup& query) const;

  void require_seen_within(const QuerySetup& query, const std::vector<LegLoad>& loads) const;

  static PlannerOptions planner_options(const QuerySetup& query, const std::string& planner);

  const ReplayOptions& options_;
  const std::filesystem::path folder_;
  const Setup& setup_;
  const Snapshot& map_;
  Robot robot_;
  std::vector<QuerySetup> queries_;          ///< of the setup, in numbers
  std::vector<std::string> notes_;           ///< on states, a sentence each
  std::vector<std::vector<LegLoad>> loads_;  ///< of each query
  std::vector<std::optional<Pick>> picks_;   ///< the same
  std::vector<std::unique_ptr<ConfigurationSpace>> spaces_;
  std::vector<std::optional<PoseGoals>> poses_;    ///< of each query, where its goals are poses
  std::vector<std::vector<Configuration>> goals_;  ///< of poses: their best configurations
  double motion_s_ = 0.0;
};

}  // namespace clearway
