#include "planning/problem/boundary_plus_stage.hpp"

#include <array>
#include <utility>

namespace clearway {
namespace {

constexpr const char* stage_statistic = "solved_by";
constexpr std::array<std::pair<BoundaryPlusStage, std::string_view>, 4> stage_names = {
    {{BoundaryPlusStage::straight_edge, "straight edge"},
     {BoundaryPlusStage::local_method, "local method"},
     {BoundaryPlusStage::plane, "plane"},
     {BoundaryPlusStage::hand_over, "hand-over"}}};

}  // namespace

std::string_view to_string(BoundaryPlusStage stage) {
  for (const auto& [known, name] : stage_names)
    if (known == stage) return name;
  return "none";
}

std::map<std::string, double> with_stage(std::map<std::string, double> statistics,
                                         std::optional<BoundaryPlusStage> stage) {
  if (stage) statistics[stage_statistic] = static_cast<double>(*stage);
  return statistics;
}

std::optional<BoundaryPlusStage> take_stage(std::map<std::string, double>& statistics) {
  const auto found = statistics.extract(stage_statistic);
  if (!found) return {};
  for (const auto& [stage, name] : stage_names)
    if (found.mapped() == static_cast<double>(stage)) return stage;
  return BoundaryPlusStage::none;
}

}  // namespace clearway
