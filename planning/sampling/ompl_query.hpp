#pragma once

// Private to the planners made of OMPL's: one query as OMPL sees it.

#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <vector>

#include "planning/sampling/sampled_trees.hpp"

namespace ompl::base {
class ProblemDefinition;
class SpaceInformation;
class State;
class StateSpace;
}  // namespace ompl::base

namespace clearway {

/// Weighted joint values, our checks, and a count of what was asked. Must stay where it is as long as OMPL
/// uses what is made of it.
struct OmplQuery {
  const PlanProblem& problem;
  Eigen::VectorXd weight;
  std::mt19937_64 random;
  SampleGuide guide;
  std::uint64_t configurations = 0, edges = 0;
  int samples = 0;

  Configuration configuration(const ompl::base::State* state) const;
  void set(ompl::base::State* state, const Configuration& q) const;
};

/// Held while generators of OMPL's are made: it seeds each from one of the whole process, which `kpiece`
/// seeds anew since the one of its grid cannot be reached.
std::mutex& ompl_seeds();

/// Weighted joint limits; where a joint may go much farther than the map and the ends, only as far as these.
/// Samples come from the query's guide, where there is one, and from its own generator: OMPL's are seeded
/// once for the whole process.
std::shared_ptr<ompl::base::StateSpace> state_space(OmplQuery& query);

/// The same with ConfigurationSpace::is_free and is_edge_free as its checks.
std::shared_ptr<ompl::base::SpaceInformation> certified_space(OmplQuery& query);

/// Start and goal of the query.
std::shared_ptr<ompl::base::ProblemDefinition> problem_definition(
    const OmplQuery& query, const std::shared_ptr<ompl::base::SpaceInformation>& information);

/// Shortens the path that OMPL found, if any, by OMPL's own simplifier, which draws from the query's
/// generator.
void simplify(OmplQuery& query, const std::shared_ptr<ompl::base::SpaceInformation>& information,
              const ompl::base::ProblemDefinition& definition);

/// The path OMPL found, its ends put back exactly; empty when there is none.
std::vector<Configuration> waypoints(const OmplQuery& query, const ompl::base::ProblemDefinition& definition);

}  // namespace clearway
