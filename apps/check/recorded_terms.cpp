#include "apps/check/recorded_terms.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

namespace {

bool is_for(const QueryTerms& query, const RecordQuestion& question) {
  return std::filesystem::path(query.robot).stem() == question.robot;
}

bool has_scale(const QueryTerms& query, double scale) {
  return std::abs(query.scale - scale) <= contract_tolerance * scale;
}

/// Of the query's start and goals; none: an older record's, of joints that nothing names.
std::vector<std::string> joints_of(const QueryTerms& query, const RecordQuestion& question) {
  const auto count = static_cast<std::size_t>(query.start.size());
  if (!query.joints.empty()) return query.joints;
  if (question.joints.size() == count) return question.joints;
  return question.usual_joints.size() == count ? question.usual_joints : std::vector<std::string>();
}

/// The value of a joint that moves, or stands still; none: it does neither.
std::optional<double> value_of(const std::string& joint, const RecordQuestion& question,
                               const Configuration& q) {
  const auto at = std::find(question.joints.begin(), question.joints.end(), joint);
  const auto j = at - question.joints.begin();
  if (at != question.joints.end()) return j < q.size() ? std::optional(q[j]) : std::nullopt;
  const auto held = question.held.find(joint);
  return held == question.held.end() ? std::nullopt : std::optional(held->second);
}

/// The question's stop as the query has its own; of no size where a joint of the query is none of the robot.
Configuration as_asked(const std::vector<std::string>& joints, const RecordQuestion& question,
                       const Configuration& stop) {
  Configuration q(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::optional<double> value = value_of(joints[j], question, stop);
    if (!value) return {};
    q[static_cast<Eigen::Index>(j)] = *value;
  }
  return q;
}

/// The query's stop in the question's joints; those that the query does not have are at `otherwise`, where
/// that is of these joints.
Configuration as_moved(const std::vector<std::string>& joints, const RecordQuestion& question,
                       const Configuration& stop, const Configuration& otherwise) {
  const auto dof = static_cast<Eigen::Index>(question.joints.size());
  Configuration q = otherwise;
  if (q.size() != dof) q = Configuration::Constant(dof, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t j = 0; j < question.joints.size(); ++j) {
    const auto at = std::find(joints.begin(), joints.end(), question.joints[j]);
    if (at != joints.end()) q[static_cast<Eigen::Index>(j)] = stop[at - joints.begin()];
  }
  return q;
}

/// With start and goals of the question's joints.
QueryTerms moved(QueryTerms query, const RecordQuestion& question) {
  const std::vector<std::string> joints = joints_of(query, question);
  if (joints.empty() || joints == question.joints) return query;
  const Configuration& start = question.start;
  const std::vector<Configuration>& goals = question.goals;
  query.start = as_moved(joints, question, query.start, start);
  for (std::size_t i = 0; i < query.goals.size(); ++i)
    query.goals[i] = as_moved(joints, question, query.goals[i],
                              goals.empty() ? start : goals[std::min(i, goals.size() - 1)]);
  query.joints = question.joints;
  return query;
}

/// Where a joint that stands still is not where the query has it.
std::vector<std::string> apart_from(const QueryTerms& query, const RecordQuestion& question) {
  std::vector<std::string> sentences;
  const std::vector<std::string> joints = joints_of(query, question);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto held = question.held.find(joints[j]);
    if (held == question.held.end()) {
      if (std::find(question.joints.begin(), question.joints.end(), joints[j]) == question.joints.end())
        sentences.push_back("joint " + shortened(joints[j]) + ": expected by the map's query " +
                            quote(query.name) + ", none of the robot's moves or is held that is called so");
      continue;
    }
    const auto value = [&](const Configuration& q) { return q[static_cast<Eigen::Index>(j)]; };
    double farthest = value(query.start);
    for (const Configuration& goal : query.goals)
      if (std::abs(value(goal) - held->second) > std::abs(farthest - held->second)) farthest = value(goal);
    if (std::abs(farthest - held->second) <= contract_tolerance) continue;
    sentences.push_back("joint " + shortened(joints[j]) + ": expected to come to " +
                        significant(farthest, 7) + " by the map's query " + quote(query.name) +
                        ", it stands at " + significant(held->second, 7));
  }
  for (std::size_t j = 0; j < question.joints.size() && !joints.empty(); ++j) {
    const auto way = [&](const Configuration& goal) {
      const auto at = static_cast<Eigen::Index>(j);
      return at < goal.size() && at < question.start.size() ? std::abs(goal[at] - question.start[at]) : 0.0;
    };
    const bool is_asked = std::find(joints.begin(), joints.end(), question.joints[j]) != joints.end();
    if (!is_asked && std::any_of(question.goals.begin(), question.goals.end(),
                                 [&](const Configuration& goal) { return way(goal) > contract_tolerance; }))
      sentences.push_back("joint " + shortened(question.joints[j]) + ": the map's query " +
                          quote(query.name) + " does not move it, the plan does");
  }
  return sentences;
}

/// The plan's own query, or that of which it is a part; null when there is none.
const QueryTerms* query_of(const QueryRecord& record, const RecordQuestion& question,
                           std::vector<std::string>& notes) {
  for (const QueryTerms& query : record.queries)
    if (!question.query.empty() && query.name == question.query) return &query;
  const auto found = [&](const QueryTerms& query, const auto& find) {
    const std::vector<std::string> joints = joints_of(query, question);
    const auto asked = [&](const Configuration& stop) {
      return joints.empty() || question.joints.empty() ? stop : as_asked(joints, question, stop);
    };
    std::vector<Configuration> goals;
    for (const Configuration& goal : question.goals) goals.push_back(asked(goal));
    return find(QueryRecord{"", {query}}, asked(question.start), goals) != nullptr;
  };
  for (const QueryTerms& query : record.queries)
    if (found(query, [](const QueryRecord& one, const auto& start, const auto& goals) {
          return one.find("", start, goals, contract_tolerance);
        }))
      return &query;
  for (const QueryTerms& query : record.queries)
    if (found(query, [](const QueryRecord& one, const auto& start, const auto& goals) {
          return one.find_whole(start, goals, contract_tolerance);
        })) {
      notes.push_back("the plan is a part of the map's query " + quote(query.name));
      return &query;
    }
  return nullptr;
}

/// Whether the plan carries it on all of its legs.
bool carries(const Plan& plan, const LegLoad& load) {
  return std::any_of(plan.loads.begin(), plan.loads.end(), [&](const LegLoad& carried) {
    if (carried.load.name != load.load.name || !is_same(carried.load, load.load)) return false;
    for (std::size_t leg = 0; leg < std::max(plan.legs.size(), plan.goals.size()); ++leg)
      if (!carried.rides_on(static_cast<int>(leg))) return false;
    return true;
  });
}

}  // namespace

std::map<std::string, Policy> RecordedTerms::loosest_policies() const {
  std::map<std::string, Policy> loosest;
  for (const QueryTerms& other : others) {
    for (const auto& [part, policy] : other.policies) {
      const auto [known, is_new] = loosest.emplace(part, policy);
      if (!is_new) known->second = std::max(known->second, policy);
    }
  }
  return loosest;
}

std::optional<double> RecordedTerms::smallest_padding() const {
  std::optional<double> smallest;
  for (const QueryTerms& other : others) smallest = std::min(smallest.value_or(other.padding), other.padding);
  return smallest;
}

double RecordedTerms::longest_age() const {
  double longest = 0.0;
  for (const QueryTerms& other : others) {
    if (other.seen_within == 0.0) return 0.0;
    longest = std::max(longest, other.seen_within);
  }
  return longest;
}

std::optional<Eigen::Isometry3d> RecordedTerms::base_instead_of(
    const Eigen::Isometry3d& map_from_base) const {
  const auto is_it = [&](const QueryTerms& other) {
    return (other.map_from_base.matrix() - map_from_base.matrix()).cwiseAbs().maxCoeff() <=
           contract_tolerance;
  };
  if (others.empty() || std::any_of(others.begin(), others.end(), is_it)) return std::nullopt;
  return others.front().map_from_base;
}

std::optional<std::vector<LegLoad>> RecordedTerms::loads_instead_of(const Plan& plan) const {
  std::optional<std::vector<LegLoad>> fewest;
  for (const QueryTerms& other : others) {
    std::vector<LegLoad> always;
    for (const LegLoad& load : other.loads)
      if (load.legs.empty()) always.push_back(load);
    if (std::all_of(always.begin(), always.end(), [&](const LegLoad& load) { return carries(plan, load); }))
      return std::nullopt;
    if (!fewest || always.size() < fewest->size()) fewest = std::move(always);
  }
  return fewest;
}

double RecordedTerms::smallest_payload() const {
  std::optional<double> smallest;
  for (const QueryTerms& other : others) {
    const double payload = other.payload.value_or(0.0);
    smallest = std::min(smallest.value_or(payload), payload);
  }
  return smallest.value_or(0.0);
}

std::optional<Eigen::Vector3d> RecordedTerms::gravity_instead_of(const Eigen::Vector3d& gravity) const {
  const auto is_it = [&](const QueryTerms& other) {
    return !other.gravity || (*other.gravity - gravity).cwiseAbs().maxCoeff() <= contract_tolerance;
  };
  if (others.empty() || std::any_of(others.begin(), others.end(), is_it)) return std::nullopt;
  return others.front().gravity;
}

RecordedTerms recorded_terms(const std::optional<QueryRecord>& record, const RecordQuestion& question,
                             const std::string& map_digest, std::vector<std::string>& notes) {
  RecordedTerms terms;
  if (!record) return terms;
  if (record->map_sha256 != map_digest) {
    notes.push_back("the folder's record of queries is of another map and does not count");
    return terms;
  }
  if (!record->made_for.empty())
    notes.push_back("the record of queries was made for the map of which `inspect` made this one");
  QueryRecord own{record->map_sha256, {}, record->made_for};
  std::copy_if(record->queries.begin(), record->queries.end(), std::back_inserter(own.queries),
               [&](const QueryTerms& query) { return is_for(query, question); });
  const QueryTerms* query = query_of(own, question, notes);
  if (query == nullptr) query = query_of(*record, question, notes);  // of another robot
  if (query != nullptr) {
    if (is_for(*query, question)) {
      terms.query = moved(*query, question);
      terms.apart = apart_from(*query, question);
      return terms;
    }
    notes.push_back("the map's query " + quote(query->name) + " is for robot " + quote(query->robot) +
                    " and does not count");
  } else {
    notes.push_back("the plan's query is none of the map's own");
  }
  for (const QueryTerms& other : record->queries)
    if (is_for(other, question) && has_scale(other, question.scale)) terms.others.push_back(other);
  if (terms.others.empty() && query == nullptr)
    notes.push_back("none of the map's queries is for " + quote(question.robot) + " at its scale");
  if (!terms.others.empty())
    notes.push_back(
        "the plan's policies, padding, ages, base, loads, payload and gravity are held to the loosest of the "
        "map's queries for " +
        quote(question.robot));
  return terms;
}

}  // namespace clearway
