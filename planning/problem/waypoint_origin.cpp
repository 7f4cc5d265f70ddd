#include "planning/problem/waypoint_origin.hpp"

#include <array>
#include <utility>

namespace clearway {
namespace {

constexpr std::array<std::pair<PathPhase, std::string_view>, 8> phase_names = {
    {{PathPhase::unknown, "unknown"},
     {PathPhase::free_motion, "free_motion"},
     {PathPhase::boundary, "boundary"},
     {PathPhase::start_tree, "start_tree"},
     {PathPhase::goal_tree, "goal_tree"},
     {PathPhase::lattice, "lattice"},
     {PathPhase::last_segment, "last_segment"},
     {PathPhase::shortened, "shortened"}}};

}  // namespace

std::string_view to_string(PathPhase phase) {
  for (const auto& [known, name] : phase_names)
    if (known == phase) return name;
  return "unknown";
}

PathPhase path_phase(std::string_view name) {
  for (const auto& [phase, known] : phase_names)
    if (known == name) return phase;
  return PathPhase::unknown;
}

}  // namespace clearway
