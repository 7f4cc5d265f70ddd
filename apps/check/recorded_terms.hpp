#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planning/files/plan_file.hpp"
#include "planning/files/query_record.hpp"

namespace clearway {

/// What a map folder's record of its queries says of a plan.
struct RecordedTerms {
  /// That the plan answers, in whole or in part, with start and goals of the plan's joints.
  std::optional<QueryTerms> query = {};
  /// Where the query has a joint elsewhere than the plan holds it, a sentence each.
  std::vector<std::string> apart = {};
  /// Of a plan that answers none of them: the queries for its robot and scale, of which it keeps at least the
  /// loosest.
  std::vector<QueryTerms> others = {};

  /// The loosest policy that the others give each part; empty: there are none.
  std::map<std::string, Policy> loosest_policies() const;
  /// The smallest padding of the others, metres.
  std::optional<double> smallest_padding() const;
  /// The longest age of the others, seconds; 0: one of them does not ask for ages.
  double longest_age() const;
  /// Where the first of the others has its base, when none of them has the plan's.
  std::optional<Eigen::Isometry3d> base_instead_of(const Eigen::Isometry3d& map_from_base) const;
  /// The fewest loads that one of the others carries all the way, when the plan carries those of none of
  /// them.
  std::optional<std::vector<LegLoad>> loads_instead_of(const Plan& plan) const;
  /// The smallest payload of the others, kg; 0: one of them does not say.
  double smallest_payload() const;
  /// The gravity of the first of the others, when each says one and none that of the plan.
  std::optional<Eigen::Vector3d> gravity_instead_of(const Eigen::Vector3d& gravity) const;
};

/// What is asked of the record: the plan's terms, or what flags state in their place.
struct RecordQuestion {
  std::string query;  ///< its name; empty: the plan does not say
  std::string robot;  ///< name
  std::size_t dof = 0;
  double scale = 1.0;
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<std::string> joints = {};        ///< of start and goals
  std::map<std::string, double> held = {};     ///< joints that stand still, as a configuration has them
  std::vector<std::string> usual_joints = {};  ///< that the robot moves where the plan has no say
};

/// @param notes gains a sentence where the record is of another map or robot, or the plan answers none of its
/// queries, or one in part
RecordedTerms recorded_terms(const std::optional<QueryRecord>& record, const RecordQuestion& question,
                             const std::string& map_digest, std::vector<std::string>& notes);

}  // namespace clearway
