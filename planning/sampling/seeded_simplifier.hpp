#pragma once

// Private to the planners made of OMPL's.

#include <ompl/geometric/PathSimplifier.h>

#include "planning/sampling/ompl_query.hpp"

namespace clearway {

/// OMPL's own simplifier with the query's seed.
class SeededSimplifier : public ompl::geometric::PathSimplifier {
 public:
  SeededSimplifier(const ompl::base::SpaceInformationPtr& information, OmplQuery& query)
      : ompl::geometric::PathSimplifier(information) {
    rng_.setLocalSeed(static_cast<std::uint_fast32_t>(query.random()));
  }
};

}  // namespace clearway
