#pragma once

#include <vector>

namespace clearway {

/// What is known of how far bodies, then pairs of bodies, are from what blocks them at one configuration,
/// metres: at least so far, and less than so far.
struct KnownClearances {
  std::vector<double> at_least, less_than;
};

}  // namespace clearway
