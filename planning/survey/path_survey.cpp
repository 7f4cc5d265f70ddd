#include "planning/survey/path_survey.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

std::ostringstream sentence() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(4);
  return text;
}

std::string place_of(const Eigen::Vector3d& point) {
  std::ostringstream text = sentence();
  text << "(" << point.x() << ", " << point.y() << ", " << point.z() << ")";
  return text.str();
}

double gap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return (a.min() - b.max()).cwiseMax(b.min() - a.max()).cwiseMax(0.0).norm();
}

/// True when the map's box is no farther from all that the robot can reach, its base included, than that is
/// wide.
bool is_about(const Robot& robot, const Eigen::AlignedBox3d& bounds) {
  Eigen::AlignedBox3d reach;
  for (const Body& body : robot.bodies) reach.extend(reach_box(robot, body));
  return !reach.isEmpty() && gap(reach, bounds) <= reach.diagonal().norm();
}

/// Where the body is farthest outside of the map's box; none when some of it is always inside.
std::optional<LeavingPart> leaving_part(const Robot& robot, const check::KdlArm& arm, std::size_t body,
                                        const std::vector<Configuration>& path,
                                        const Eigen::AlignedBox3d& bounds, double spacing) {
  std::optional<LeavingPart> farthest;
  visit_body_poses(arm, body, path, spacing, [&](const Eigen::Isometry3d& pose, const PathPlace& place) {
    const Eigen::AlignedBox3d box = robot.bodies[body].shape.bounds(pose);
    if (!bounds.isEmpty() && bounds.intersects(box)) return;
    const double distance = bounds.isEmpty() ? std::numeric_limits<double>::infinity() : gap(bounds, box);
    if (farthest && distance <= farthest->distance) return;
    farthest = LeavingPart{robot.bodies[body].part, distance, box.center(), place};
  });
  return farthest;
}

std::string describe_leaving(const std::vector<LeavingPart>& leaving) {
  const LeavingPart& first = *std::max_element(
      leaving.begin(), leaving.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
  std::set<std::string> names;
  for (const LeavingPart& part : leaving) names.insert(part.part);
  std::ostringstream text = sentence();
  text << to_text(first) << ", on edge " << first.place.edge << " at " << first.place.parameter;
  names.erase(first.part);
  if (!names.empty()) text << " (and so do " << listed({names.begin(), names.end()}) << ")";
  return text.str() + why_refused_outside(names.empty() ? first.part : "all");
}

}  // namespace

bool can_be_left(const Robot& robot, const Snapshot& map) {
  const Eigen::AlignedBox3d bounds = map.bounds();
  return map.holds_any({VoxelState::seen_free}) || bounds.isEmpty() || !is_about(robot, bounds);
}

bool is_allowed_outside(const std::string& part, const std::vector<std::string>& allow_outside) {
  return std::any_of(allow_outside.begin(), allow_outside.end(),
                     [&](const std::string& name) { return name == "all" || name == part; });
}

std::string to_text(const LeavingPart& leaving) {
  std::ostringstream text = sentence();
  text << shortened(leaving.part) << " leaves the map's bounds";
  if (std::isfinite(leaving.distance)) text << " by " << leaving.distance << " m";
  text << " at " << place_of(leaving.point);
  return text.str();
}

std::string why_refused_outside(const std::string& part) {
  return ": nothing is known of that place, which the policy not_occupied counts as free; allow it by name "
         "with --allow-outside " +
         shortened(part);
}

PathSurvey survey_path(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                       const std::vector<Configuration>& path) {
  PathSurvey survey;
  survey.swept = swept_voxels(robot, map, path);
  survey.standing = standing_contacts(robot, map);
  const check::KdlArm arm(without_file(robot));
  const VoxelCounts counts = map.counts();
  const Eigen::AlignedBox3d bounds = map.bounds();
  const bool may_leave = can_be_left(robot, map);
  survey.is_of_obstacles_alone = counts.seen_free + counts.painted + counts.conflict == 0;
  std::set<std::string> unknown_free;
  for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
    const std::string& part = robot.bodies[body].part;
    const auto policy = policies.find(part);
    if (!arm.is_policed(body) || (policy != policies.end() && policy->second != Policy::not_occupied))
      continue;
    unknown_free.insert(part);
    if (!may_leave || path.empty()) continue;
    if (auto leaving = leaving_part(robot, arm, body, path, bounds, map.resolution()))
      survey.leaving.push_back(std::move(*leaving));
  }
  survey.unknown_free.assign(unknown_free.begin(), unknown_free.end());
  survey.only_seen = robot.only_seen;
  return survey;
}

namespace {

void add_swept(const std::optional<SweptVoxels>& more, std::optional<SweptVoxels>& all) {
  if (!more || !all) {  // what cannot be counted on one leg is not known of all
    all.reset();
    return;
  }
  all->painted += more->painted;
  all->seen_free += more->seen_free;
  all->seen_once += more->seen_once;
  all->maybe_by_hand += more->maybe_by_hand;
  all->occupied += more->occupied;
  all->unknown += more->unknown;
  all->beyond += more->beyond;
  const bool is_known = more->oldest_look && all->oldest_look;
  all->oldest_look = is_known ? std::optional(std::max(*more->oldest_look, *all->oldest_look)) : std::nullopt;
}

template <typename Item>
void add_new(const std::vector<Item>& more, std::vector<Item>& all) {
  for (const Item& item : more)
    if (std::find(all.begin(), all.end(), item) == all.end()) all.push_back(item);
}

}  // namespace

PathSurvey survey_legs(const std::vector<LegsToCheck>& legs, const std::map<std::string, Policy>& policies) {
  PathSurvey all;
  int first_edge = 0;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    PathSurvey part = survey_path(legs[i].robot, legs[i].map, policies, legs[i].waypoints);
    for (LeavingPart& leaving : part.leaving) leaving.place.edge += first_edge;
    first_edge += std::max(0, static_cast<int>(legs[i].waypoints.size()) - 1);
    if (i == 0) {
      all = std::move(part);
      continue;
    }
    add_swept(part.swept, all.swept);
    add_new(part.standing, all.standing);
    add_new(part.unknown_free, all.unknown_free);
    std::sort(all.unknown_free.begin(), all.unknown_free.end());
    all.leaving.insert(all.leaving.end(), part.leaving.begin(), part.leaving.end());
  }
  return all;
}

std::string describe_standing(const std::vector<StandingContact>& standing) {
  std::ostringstream text = sentence();
  for (const StandingContact& contact : standing) {
    if (&contact != &standing.front()) text << "; ";
    text << shortened(contact.part) << " touches " << contact.voxels << " occupied voxel"
         << (contact.voxels == 1 ? "" : "s, the lowest") << " at " << place_of(contact.lowest);
  }
  return text.str();
}

std::string unknown_sentence(const PathSurvey& survey) {
  if (survey.unknown_free.empty()) return {};
  const std::string parts = listed(survey.unknown_free);
  return survey.is_of_obstacles_alone
             ? "nothing in the map is known to be free: unknown space counts as free for " + parts
             : "unknown space counts as free for " + parts + " (policy not_occupied)";
}

std::string only_seen_sentence(const std::vector<std::string>& links) {
  if (links.empty()) return {};
  const bool is_one = links.size() == 1;
  return (is_one ? "link " + listed(links) + " has" : "links " + listed(links) + " have") +
         " a visual shape but no collision shape: nothing of " + (is_one ? "it" : "them") + " is checked";
}

std::optional<std::string> refusal(const PathSurvey& survey, const SurveyDemands& demands) {
  std::vector<LeavingPart> leaving;
  for (const LeavingPart& part : survey.leaving) {
    if (!is_allowed_outside(part.part, demands.allow_outside)) leaving.push_back(part);
  }
  if (!leaving.empty()) return describe_leaving(leaving);
  if (demands.strict && !survey.standing.empty())
    return "no joint moves it, but " + describe_standing(survey.standing) + ", which --strict refuses";
  if (demands.strict && !survey.only_seen.empty())
    return only_seen_sentence(survey.only_seen) + ", which --strict refuses";
  return std::nullopt;
}

void refuse_surveyed(const PathSurvey& survey, const SurveyDemands& demands, PathVerdict& verdict) {
  const auto reason = refusal(survey, demands);
  if (!reason || !verdict.valid) return;
  verdict.valid = false;
  verdict.first_contact = *reason;
}

void require_parts(const std::vector<std::string>& allow_outside, const Robot& robot,
                   const std::string& what) {
  std::set<std::string> parts;
  for (const Body& body : robot.bodies) parts.insert(body.part);
  for (const std::string& part : allow_outside) {
    if (part == "all" || parts.contains(part)) continue;
    const std::string names = listed({parts.begin(), parts.end()});
    throw std::invalid_argument(what + ": expected all or a part of " + robot.name + " (" + names +
                                "), got " + quote(part));
  }
}

}  // namespace clearway
