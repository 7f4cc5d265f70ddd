#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// A value of a run; nothing where planner or team does not report it: NULL in the database, empty in the
/// CSV.
using CompareCell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// What database and CSV hold of every run.
struct RunColumn {
  std::string name;
  const char* sql_type;
  std::function<CompareCell(const CompareRun& run, const ComparePlanner& who)> cell;
};

/// In their order; names are unique. Times that a clock took stand in `time_s` (to plan, wall
/// clock), `cpu_s` (the same, CPU), `search_cpu_s`, `shortcut_cpu_s` and `proof_cpu_s` (its parts),
/// `space_cpu_s` and `derive_cpu_s` (before), `check_s`, `check_cpu_s` and `motion_cpu_s` (after) and nowhere
/// else.
const std::vector<RunColumn>& run_columns();

/// The statistics of a plan that have columns, of all its legs together: counts are added up, separations are
/// the least, all else is the largest.
std::map<std::string, double> column_statistics(const std::vector<PlanResult>& legs);

/// The last stage that was needed, none of another planner.
std::optional<BoundaryPlusStage> solving_stage(const std::vector<PlanResult>& legs);

}  // namespace clearway
