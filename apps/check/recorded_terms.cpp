#include "apps/check/recorded_terms.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

namespace {

bool is_for(const QueryTerms& query, const RecordQuestion& question) {
  return std::filesystem::path(query.robot).stem() == question.robot &&
         query.start.size() == static_cast<Eigen::Index>(question.dof);
}

bool has_scale(const QueryTerms& query, double scale) {
  return std::abs(query.scale - scale) <= contract_tolerance * scale;
}

/// The plan's own query, or that of which it is a part; null when there is none.
const QueryTerms* query_of(const QueryRecord& record, const RecordQuestion& question,
                           std::vector<std::string>& notes) {
  const QueryTerms* query = record.find(question.query, question.start, question.goals, contract_tolerance);
  if (query) return query;
  query = record.find_whole(question.start, question.goals, contract_tolerance);
  if (query) notes.push_back("the plan is a part of the map's query " + quote(query->name));
  return query;
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
  if (const QueryTerms* query = query_of(*record, question, notes)) {
    if (is_for(*query, question)) {
      terms.query = *query;
      return terms;
    }
    notes.push_back("the map's query " + quote(query->name) + " is for robot " + quote(query->robot) +
                    " and does not count");
  } else {
    notes.push_back("the plan's query is none of the map's own");
  }
  for (const QueryTerms& query : record->queries)
    if (is_for(query, question) && has_scale(query, question.scale)) terms.others.push_back(query);
  if (!terms.others.empty())
    notes.push_back("the plan's policies are held to the loosest of the map's queries for " +
                    quote(question.robot));
  return terms;
}

}  // namespace clearway
