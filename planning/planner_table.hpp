#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "planning/problem/planner.hpp"

namespace clearway {

/// A planner that users name.
struct PlannerEntry {
  std::string_view name;
  std::string_view description;
  std::unique_ptr<Planner> (*make)(const PlannerOptions&);  ///< with options in text form
  bool certifies = true;  ///< with its defaults: each edge of its paths is proved free
};

/// The explicit table of planners, in the order shown to users.
const std::vector<PlannerEntry>& planner_table();

/// @throws std::invalid_argument for an unknown planner or option, naming the nearest known one, or for a
///         value out of range, naming option, value and range.
std::unique_ptr<Planner> make_planner(std::string_view name, const PlannerOptions& options = {});

}  // namespace clearway
