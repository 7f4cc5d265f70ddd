#include "planning/check/check_legs.hpp"

#include <algorithm>

namespace clearway {
namespace {

/// "edge 3 at 0.5: …" with the edge's number in the whole path.
std::string renumbered(const std::string& sentence, int edge, int first) {
  const std::string own = "edge " + std::to_string(edge) + " at ";
  if (!sentence.starts_with(own)) return sentence;
  return "edge " + std::to_string(edge + first) + " at " + sentence.substr(own.size());
}

void append(const PathVerdict& part, int first_edge, PathVerdict& whole) {
  const bool is_first = whole.clearance.empty();
  whole.min_clearance =
      part.valid && !is_first ? std::min(whole.min_clearance, part.min_clearance) : part.min_clearance;
  std::size_t next = 0;
  if (!is_first && !part.clearance.empty()) {  // where both legs meet
    whole.clearance.back() = std::min(whole.clearance.back(), part.clearance.front());
    next = 1;
  }
  for (; next < part.clearance.size(); ++next) whole.clearance.push_back(part.clearance[next]);
  whole.valid = part.valid;
  whole.undecided = part.undecided;
  whole.parameter = part.parameter;
  whole.edge = part.edge < 0 ? part.edge : part.edge + first_edge;
  whole.first_contact = renumbered(part.first_contact, part.edge, first_edge);
}

}  // namespace

PathVerdict check_legs(const std::vector<LegsToCheck>& legs, const std::map<std::string, Policy>& policies,
                       double padding, double distance_cap, double seen_within) {
  PathVerdict whole;
  whole.first_contact = "the path has no waypoints";
  int first_edge = 0;
  const Configuration* end = nullptr;
  for (const LegsToCheck& part : legs) {
    if (part.waypoints.empty()) continue;
    std::vector<Configuration> path = part.waypoints;
    const bool is_joined = end != nullptr && *end == path.front();
    if (end != nullptr && !is_joined) path.insert(path.begin(), *end);
    append(check_tubes(part.robot, part.map, policies, padding, path, {}, distance_cap, seen_within),
           first_edge, whole);
    if (!whole.valid) return whole;
    first_edge += static_cast<int>(path.size()) - 1;
    end = &part.waypoints.back();
  }
  return whole;
}

}  // namespace clearway
