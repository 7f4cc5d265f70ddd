#pragma once

// Private to the planners made of OMPL's: the algorithms, with generators that the query seeds.

#include <functional>
#include <memory>

#include "planning/sampling/ompl_query.hpp"

namespace ompl::base {
class Planner;
}  // namespace ompl::base

namespace clearway {

enum class OmplAlgorithm { rrtconnect, est, prm, rrtstar, bitstar, kpiece };

/// Whether it improves its path after the first; so many samples as are allowed for that end no search
/// without one.
inline bool improves_path(OmplAlgorithm algorithm) {
  return algorithm == OmplAlgorithm::rrtstar || algorithm == OmplAlgorithm::bitstar;
}

/// What makes one; fields that the algorithm has no use for are left alone.
struct OmplAlgorithmOptions {
  OmplAlgorithm algorithm = OmplAlgorithm::rrtconnect;
  double range = 0.0;  ///< longest edge tried, weighted units; 0: OMPL's choice
  int batch = 0;       ///< samples of a batch
};

/// The planner, set up for `definition`, which gets an objective where the algorithm improves its path. All
/// draws that decide the path come from the query's seed.
/// @param is_over asked between samples; must stay where it is, like the query, as long as the planner does
std::shared_ptr<ompl::base::Planner> make_algorithm(
    const OmplAlgorithmOptions& options, OmplQuery& query,
    const std::shared_ptr<ompl::base::SpaceInformation>& information,
    const std::shared_ptr<ompl::base::ProblemDefinition>& definition, const std::function<bool()>& is_over);

}  // namespace clearway
