#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace clearway {

/// What joined start and goal of `boundary_plus`, in the order in which its stages cost more.
enum class BoundaryPlusStage { straight_edge, local_method, plane, hand_over, none };
/// "straight edge", "local method", "plane", "hand-over" or "none".
std::string_view to_string(BoundaryPlusStage stage);

// Files keep the stage among a plan's statistics, which are numbers: as `solved_by`, its place from 0.

/// The statistics with the stage's number, where there is one.
std::map<std::string, double> with_stage(std::map<std::string, double> statistics,
                                         std::optional<BoundaryPlusStage> stage);

/// Takes the stage's number out; `none` for a number that is no stage's.
std::optional<BoundaryPlusStage> take_stage(std::map<std::string, double>& statistics);

}  // namespace clearway
